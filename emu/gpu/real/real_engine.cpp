// SPDX-License-Identifier: MIT
// The rule in floats or doubles.
#include <algorithm>
#include <cmath>

#include "emu/gpu/device/memory_words.h"
#include "emu/gpu/machine.h"
#include "emu/gpu/messages.h"
#include "emu/gpu/real/real_policy.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/contract/neighbours.h"

namespace cuboct::gpu {
namespace {

// Cells as wide as the cutoff and the thickest skin.
constexpr double kLargestSkin = 0.16, kEdge = 1 + kLargestSkin + 1e-4;

// Cells of a fluid or a solid hold a few particles; more empty ones than these cost more memory than they
// save time.
constexpr uint64_t kCellsPerParticle = 4, kLeastCells = 4096;

template <class Real>
class RealEngine final : public Engine {
 public:
  using Policy = RealPolicy<Real>;

  RealEngine(const Scene& scene, const Body& body, const Options& options, const Memory* memory)
      : scene_(scene), tables_(scene.rule), type_(body.type) {
    place(body);
    typename Machine<Policy>::Setup setup;
    setup.geometry = geometry_;
    // Floats of a cell's coordinates, of both of a pair along three axes.
    setup.rounding = 16 * static_cast<double>(std::numeric_limits<float>::epsilon());
    setup.largest_skin = kLargestSkin;
    setup.pd = tables_.rule().pd, setup.damped = tables_.rule().damped;
    setup.edge = geometry_.edge;
    for (int a = 0; a < 3; ++a) setup.origin[a] = origin_[a] / tables_.length;
    double edge[3];
    std::copy(geometry_.edge.begin(), geometry_.edge.end(), edge);
    machine_ = std::make_unique<Machine<Policy>>(
        options, setup, EnergyTables(scene.rule), host(body),
        [&](Stream& stream) { return std::make_unique<RealRuleOnDevice<Real>>(stream, tables_, edge); });
    if (memory) restore(*memory);
  }

  void advance(uint64_t steps, std::vector<uint64_t>*) override {
    const uint64_t last = step_ + steps;
    while (step_ < last && !interrupted()) {
      if (old_) renew();
      const auto outcome = machine_->run(last - step_, nullptr);
      step_ += outcome.done;
      using End = typename Machine<Policy>::End;
      old_ = outcome.end != End::full && outcome.end != End::near_list;
      if (outcome.end == End::doubt) throw_not_finite();
    }
  }
  uint64_t step_count() const override { return step_; }

  Reading read(bool energies) override {
    if (old_) renew();
    Reading reading;
    reading.step = step_;
    for (const Found<Policy>& found : machine_->read_probed()) {
      reading.x.push_back(position(found.x, found.cell));
      reading.force.push_back(tables_.force * Vec3(found.kick.at[0], found.kick.at[1], found.kick.at[2]));
      reading.v.push_back(tables_.velocity * Vec3(found.v[0], found.v[1], found.v[2]));
    }
    if (energies) {
      const Sums sums = machine_->read_energies();
      reading.energies = energies_of(sums, tables_.velocity);
      reading.virial = sums.virial;
      reading.largest_speed = sums.speed * tables_.velocity;
    }
    return reading;
  }
  void probe(const std::vector<uint32_t>& ids) override { machine_->probe(ids); }

  State state() override { throw std::logic_error("a real engine has no fixed state"); }
  uint64_t hash() override { throw std::logic_error("a real engine has no hash"); }

  Body body() override {
    // Whether new lists have been made since the last step shows in the last bits: they make positions count
    // from other cells.
    if (old_) renew();
    const HostParticles<Policy> host = machine_->download();
    Body body;
    const size_t n = host.size();
    body.x.resize(n), body.v.resize(n);
    body.type = type_;
    if (!host.u.empty()) body.u.resize(n);
    for (size_t i = 0; i < n; ++i) {
      const uint32_t id = host.id[i];
      body.x[id] = position(host.x[i], host.cell[i]);
      const auto& v = host.v[i].at;
      body.v[id] = tables_.velocity * Vec3(v[0], v[1], v[2]);
      if (host.u.empty()) continue;
      const auto& u = host.u[i].at;
      body.u[id] = tables_.length * Vec3(u[0], u[1], u[2]);
    }
    return body;
  }

  std::vector<uint64_t> memory() override {
    if (old_) renew();  // as the next step would
    const Kept<Policy> kept = machine_->keep();
    std::vector<uint64_t> words;
    put(words, kept.state.x), put(words, kept.state.v), put(words, kept.state.u);
    put(words, kept.state.cell), put(words, kept.state.id), put(words, kept.listed);
    put<Skin::Memory>(words, {kept.skin});
    words.push_back(kept.age);
    return words;
  }

  const Counters& counters() const override { return machine_->counters; }

 private:
  void restore(const Memory& memory) {
    std::span<const uint64_t> words = memory.words;
    const size_t n = type_.size();
    Kept<Policy> kept;
    kept.state.x = take<typename Policy::Position>(words, n);
    kept.state.v = take<typename Policy::Velocity>(words, n);
    kept.state.u = take<typename Policy::Extra>(words, tables_.rule().pd ? n : 0);
    kept.state.cell = take<CellAt>(words, n);
    kept.state.id = take<uint32_t>(words, n);
    kept.listed = take<typename Policy::Position>(words, n);
    kept.skin = take<Skin::Memory>(words, 1).front();
    if (words.size() != 1) throw DamagedMemory("its lists have other lengths");
    kept.age = words[0];
    check(kept);
    if (!machine_->restore(kept)) throw DamagedMemory("no pair list has such a skin");
    step_ = memory.step;
  }

  void check(const Kept<Policy>& kept) const {
    std::vector<bool> seen(type_.size());
    const auto near = [](Real x) { return std::abs(x) < Real(1e6); };
    for (size_t k = 0; k < type_.size(); ++k) {
      const uint32_t id = kept.state.id[k];
      if (id >= seen.size() || seen[id]) throw DamagedMemory("a particle is missing");
      seen[id] = true;
      bool sound = type_in(kept.state.x[k].last) == type_[id] && type_in(kept.listed[k].last) == type_[id];
      for (int a = 0; a < 3; ++a)
        sound = sound && near(kept.state.x[k].at[a]) && near(kept.listed[k].at[a]) &&
                std::isfinite(kept.state.v[k].at[a]) && std::abs(kept.state.cell[k].c[a]) < 1'000'000'000 &&
                (kept.state.u.empty() || std::isfinite(kept.state.u[k].at[a]));
      if (!sound) throw DamagedMemory("particle " + std::to_string(id) + " cannot be one of the scene's");
    }
  }

  // Chooses cells: whole ones in a box that repeats, else from the body's lowest corner on.
  void place(const Body& body) {
    CellList(scene_.rule.cutoff(), scene_.periodic);  // refuses a box in which pairs meet twice
    Vec3 low = body.x[0], high = body.x[0];
    for (const Vec3& x : body.x) low = low.cwiseMin(x), high = high.cwiseMax(x);
    const double length = tables_.length;
    for (int a = 0; a < 3; ++a) {
      const double extent = scene_.periodic.extent[a] / length;
      geometry_.wraps[a] = extent > 0;
      if (extent > 0) {
        origin_[a] = scene_.periodic.origin[a];
        geometry_.total[a] = std::max(1, static_cast<int>(extent / kEdge));
        geometry_.edge[a] = extent / geometry_.total[a];
      } else {
        geometry_.edge[a] = kEdge;
        origin_[a] = low[a] - 0.5 * kEdge * length;
        geometry_.total[a] = static_cast<int>(std::min((high[a] - origin_[a]) / (kEdge * length), 1e6)) + 2;
      }
    }
    geometry_.folds = true;
    geometry_.reach = Policy::kReach;
    const uint64_t most = kCellsPerParticle * body.size() + kLeastCells;
    const auto cells = [&] {
      return static_cast<uint64_t>(geometry_.total[0]) * geometry_.total[1] * geometry_.total[2];
    };
    while (cells() > most) {
      int longest = -1;
      for (int a = 0; a < 3; ++a)
        if (!geometry_.wraps[a] && (longest < 0 || geometry_.total[a] > geometry_.total[longest]))
          longest = a;
      if (longest < 0 || geometry_.total[longest] < 2) break;
      geometry_.total[longest] = (geometry_.total[longest] + 1) / 2;
    }
  }

  HostParticles<Policy> host(const Body& body) const {
    HostParticles<Policy> host;
    const size_t n = body.size();
    host.x.resize(n), host.v.resize(n), host.cell.resize(n), host.id.resize(n);
    const bool pd = tables_.rule().pd;
    if (pd) host.u.resize(n);
    for (size_t i = 0; i < n; ++i) {
      for (int a = 0; a < 3; ++a) {
        const double at = (body.x[i][a] - origin_[a]) / tables_.length, edge = geometry_.edge[a];
        const double cell = std::floor(at / edge);
        if (!(std::abs(cell) < 1e9)) throw_far_particle(i);
        host.cell[i].c[a] = static_cast<int32_t>(cell);
        host.x[i].at[a] = static_cast<Real>(at - cell * edge);
        host.v[i].at[a] = static_cast<Real>(body.v[i][a] / tables_.velocity);
        if (pd) host.u[i].at[a] = body.u.empty() ? Real(0) : static_cast<Real>(body.u[i][a] / tables_.length);
      }
      host.x[i].last = body.type[i];
      host.id[i] = static_cast<uint32_t>(i);
    }
    return host;
  }

  Vec3 position(const typename Policy::Position& x, const CellAt& cell) const {
    Vec3 position;
    for (int a = 0; a < 3; ++a)
      position[a] =
          origin_[a] + (cell.c[a] * geometry_.edge[a] + static_cast<double>(x.at[a])) * tables_.length;
    return position;
  }

  void renew() {
    machine_->make_lists();
    old_ = false;
  }

  [[noreturn]] void throw_not_finite() {
    const Body now = body();
    size_t fastest = 0;
    for (size_t i = 0; i < now.size(); ++i)
      if (!(now.v[i].squaredNorm() <= now.v[fastest].squaredNorm())) fastest = i;
    gpu::throw_not_finite(step_, static_cast<uint32_t>(fastest), now.v[fastest].norm());
  }

  const Scene& scene_;
  RealTables<Real> tables_;
  std::vector<uint8_t> type_;
  Vec3 origin_ = Vec3::Zero();  // m, of cell (0,0,0)
  Geometry geometry_;
  std::unique_ptr<Machine<Policy>> machine_;
  uint64_t step_ = 0;
  bool old_ = false;  // the lists no longer serve
};

std::unique_ptr<Engine> make(const Scene& scene, const Body& body, Arithmetic arithmetic,
                             const Options& options, const Memory* memory) {
  if (arithmetic == Arithmetic::float32)
    return std::make_unique<RealEngine<float>>(scene, body, options, memory);
  return std::make_unique<RealEngine<double>>(scene, body, options, memory);
}

}  // namespace

std::unique_ptr<Engine> make_real_engine(const Scene& scene, const Body& body, Arithmetic arithmetic,
                                         const Options& options) {
  return make(scene, body, arithmetic, options, nullptr);
}

std::unique_ptr<Engine> resume_real_engine(const Scene& scene, const Body& body, Arithmetic arithmetic,
                                           const Options& options, const Memory& memory) {
  return make(scene, body, arithmetic, options, &memory);
}

}  // namespace cuboct::gpu
