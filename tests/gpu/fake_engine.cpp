// SPDX-License-Identifier: MIT
// Engines of gpu_ref/engine.h over golden and the reference, to try the program around them.
#include <cstdlib>

#include "gpu_ref/engine.h"
#include "model/golden.h"
#include "model/interrupt.h"
#include "model/reference.h"

namespace cuboct::gpu {
namespace {

class Fixed : public Engine {
 public:
  Fixed(const Scene& scene, const Plan& plan, const State& initial)
      : scene_(scene), plan_(plan), golden_(plan.rule, plan.lattice, plan.arch.capacity, initial) {}
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    for (uint64_t k = 0; k < steps && (k == 0 || !interrupted()); ++k) {
      golden_.step();
      if (hashes) hashes->push_back(hash());
    }
  }
  uint64_t step_count() const override { return golden_.step_count(); }
  Reading read(bool energies) override {
    const State state = golden_.state();
    const auto kicks = summed_kicks(plan_.rule, plan_.lattice, state);
    Reading r;
    r.step = state.step;
    for (const uint32_t id : ids_) {
      r.x.push_back(position_of(plan_.rule, plan_.lattice, plan_.origin, state.particles[id]));
      r.force.push_back(force_of(plan_.rule, kicks[id]));
    }
    if (energies) {
      r.energies = cuboct::energies(scene_.rule, plan_.rule, plan_.lattice, plan_.origin, state, kicks);
      r.virial = -virial_stress(plan_.rule, plan_.lattice, state, 1).trace();
    }
    r.largest_speed = largest_speed(plan_.rule, state) * plan_.rule.cell_edge / plan_.rule.dt;
    return r;
  }
  void probe(const std::vector<uint32_t>& ids) override { ids_ = ids; }
  State state() override { return golden_.state(); }
  uint64_t hash() override { return hash_of(plan_.lattice, golden_.state()); }
  Body body() override { return to_real(state(), plan_.rule, plan_.lattice, plan_.origin); }
  const Counters& counters() const override { return counters_; }

 private:
  const Scene& scene_;
  const Plan& plan_;
  Golden golden_;
  std::vector<uint32_t> ids_;
  Counters counters_;
};

class Real : public Engine {
 public:
  Real(const Scene& scene, const Body& body, Precision precision)
      : scene_(scene), reference_(scene.rule, body, scene.periodic, RealOptions{.precision = precision}) {}
  void advance(uint64_t steps, std::vector<uint64_t>*) override {
    for (uint64_t k = 0; k < steps && (k == 0 || !interrupted()); ++k) reference_.step();
  }
  uint64_t step_count() const override { return reference_.step_count(); }
  Reading read(bool energies) override {
    const Body& body = reference_.body();
    const auto force = reference_.forces();
    Reading r;
    r.step = step_count();
    for (const uint32_t id : ids_) r.x.push_back(body.x[id]), r.force.push_back(force[id]);
    for (const Vec3& v : body.v) r.largest_speed = std::max(r.largest_speed, v.cwiseAbs().maxCoeff());
    if (!energies) return r;
    Energies& e = r.energies;
    for (size_t i = 0; i < body.size(); ++i) {
      const Vec3 v = body.v[i] + scene_.rule.dt / 2 * acceleration(scene_.rule, body, i, force[i]);
      e.kinetic += scene_.rule.mass * v.squaredNorm() / 2;
      e.gravity -= scene_.rule.mass * scene_.rule.types[body.type[i]].gravity.dot(body.x[i]);
    }
    e.potential = reference_.potential_energy();
    double trace = 0;
    for (const Mat3& stress : reference_.virial_stress(1)) trace += stress.trace();
    r.virial = -trace;
    return r;
  }
  void probe(const std::vector<uint32_t>& ids) override { ids_ = ids; }
  State state() override { throw std::runtime_error("no State"); }
  uint64_t hash() override { return 0; }
  Body body() override { return reference_.body(); }
  const Counters& counters() const override { return counters_; }

 private:
  const Scene& scene_;
  Reference reference_;
  std::vector<uint32_t> ids_;
  Counters counters_;
};

}  // namespace

const char* to_string(Arithmetic a) {
  return a == Arithmetic::fixed ? "fixed" : a == Arithmetic::float32 ? "float" : "double";
}
std::unique_ptr<Engine> make_fixed_engine(const Scene& scene, const Plan& plan, const State& initial,
                                          const Options&) {
  return std::make_unique<Fixed>(scene, plan, initial);
}
std::unique_ptr<Engine> make_real_engine(const Scene& scene, const Body& body, Arithmetic arithmetic,
                                         const Options&) {
  return std::make_unique<Real>(scene, body,
                                arithmetic == Arithmetic::float32 ? Precision::float32 : Precision::float64);
}
std::vector<Device> find_devices(std::string* why) {
  if (std::getenv("NO_DEVICE")) {
    if (why) *why = "no driver (libcuda.so.1)";
    return {};
  }
  return {{0, "a host", "", 1, 0, 0}, {1, "another host", "", 1, 0, 0}};
}

}  // namespace cuboct::gpu
