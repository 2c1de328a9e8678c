// SPDX-License-Identifier: MIT
#include "model/real/rounds_engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "model/base/error.h"

namespace cuboct {
namespace {

Body as_packed(Body body) {
  if (body.bonds) body.x = body.bonds->packed;
  return body;
}

// The box in which as_packed() stands.
const Periodic& box_of_packed(const Body& body, const Periodic& now, const RealOptions& options) {
  return body.bonds && options.deform ? options.deform->packed : now;
}

class RoundsEngine final : public RealEngine {
 public:
  RoundsEngine(const Rule& rule, const Body& body, const Periodic& periodic, const RealOptions& options)
      : rule_(rule),
        options_(options),
        x_(body.x),
        v_(body.v),
        u_(body.u),
        type_(body.type),
        rounds_(*rule.rounds),
        remembers_(has_memory(rule)),
        box_(periodic),
        terms_(rounds_.bind(rule, as_packed(body), box_of_packed(body, periodic, options), options.threads)),
        steps_(options.first_step) {
    if (options.deform) terms_->set_box(box_);
    recall_bonds(*terms_, body);
    for (const Vec3& v : v_) fastest_ = std::max(fastest_, v.cwiseAbs().maxCoeff());
    if (!options.on_demand) refresh();
    kick_.clear();
  }

  void step(uint64_t number) override {
    try {
      const double dt = rule_.dt;
      if (options_.integrator == Integrator::semi_implicit_euler) {
        if (!fresh_ || remembers_) evaluate(true);
        carry(number + 1);
        move(dt, dt);
        ++steps_;
        fresh_ = false;
        // What keeps nothing is looked at as the next step will look: a step does not end in a state of which
        // the rounds cannot be run.
        if (!remembers_) evaluate(false);
      } else {
        carry(number + 1);
        move(dt / 2, dt);
        ++steps_;
        kick_.clear();
        evaluate(true);
        move(dt / 2, 0);
        fresh_ = false;
      }
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("step {}: {}; is dt too long?", number, error.what()));
    }
  }

  void read(Body& body) const override { body.x = x_, body.v = v_, body.u = u_; }
  void place(const Body& body, uint64_t step) override {
    x_ = body.x, v_ = body.v, steps_ = step;
    if (options_.deform) set_box(options_.deform->at(step));
    if (!u_.empty()) u_ = body.u;
    fresh_ = false;
    kick_.clear();
  }
  std::vector<Vec3> forces() const override {
    refresh();
    return terms_->force();
  }
  const RoundsTerms* terms() const override {
    refresh();
    return terms_.get();
  }
  const RoundsTerms* kept_terms() const override { return terms_.get(); }
  void give_way() override { evaluate(true); }
  double largest_speed() const override { return fastest_; }
  const NearList& list() const override { throw std::logic_error("a rule of rounds has no list of pairs"); }
  uint64_t lists_made() const override { return 1; }
  std::vector<uint64_t> memory() const override { return terms_->memory(); }
  void recall(const std::vector<uint64_t>& memory) override {
    terms_->recall(memory);
    fresh_ = false;
    kick_.clear();
  }

 private:
  void set_box(const Periodic& box) {
    box_ = box;
    terms_->set_box(box);
  }
  // The particles go with the box to that of a step.
  void carry(uint64_t step) {
    if (!options_.deform) return;
    const Periodic next = options_.deform->at(step);
    BoxStretch(box_, next).carry(x_);
    set_box(next);
  }
  void evaluate(bool keeps) const {
    terms_->velocities(v_);
    terms_->time(steps_);
    terms_->begin(x_);
    run_rounds(*terms_, rounds_.declaration().rounds.size(), x_.size(), keeps, options_.threads);
    fresh_ = true;
  }
  void refresh() const {
    if (fresh_) return;
    // Velocity Verlet kicks twice with the forces of the half step's velocities: a look at the full step's is
    // not to come between.
    if (options_.integrator == Integrator::velocity_verlet && kick_.empty()) kick_ = terms_->force();
    try {
      evaluate(false);
    } catch (const std::runtime_error& error) {
      throw RoundsError(error.what());
    }
  }

  // v += a * kick with imposed velocities; then u and x by v * drift.
  void move(double kick, double drift) {
    if (!rounds_.declaration().moves) return;
    const std::vector<Vec3>& f = kick_.empty() ? terms_->force() : kick_;
    for (size_t i = 0; i < x_.size(); ++i) {
      const ParticleType& type = rule_.types[type_[i]];
      Vec3 force = f[i];
      if (type.pd) force -= type.kp * u_[i] + type.kd * (v_[i] - type.velocity);
      const Vec3 a = force / rule_.mass_of(type_[i]) + type.gravity;
      for (int axis = 0; axis < 3; ++axis)
        v_[i][axis] = type.imposed[axis] ? type.velocity[axis] : v_[i][axis] + a[axis] * kick;
      fastest_ = std::max(fastest_, v_[i].cwiseAbs().maxCoeff());
      if (type.pd) u_[i] += (v_[i] - type.velocity) * drift;
      x_[i] += v_[i] * drift;
    }
  }

  const Rule rule_;
  const RealOptions options_;
  std::vector<Vec3> x_, v_, u_;
  std::vector<uint8_t> type_;
  const RoundsRule& rounds_;  // of rule_
  const bool remembers_;
  Periodic box_;  // of x_
  std::unique_ptr<RoundsTerms> terms_;
  uint64_t steps_;                  // that led to x_
  mutable bool fresh_ = false;      // the terms are those of x_
  mutable std::vector<Vec3> kick_;  // N, of the last step's end, where a look has evaluated the rounds since
  double fastest_ = 0;
};

}  // namespace

std::unique_ptr<RealEngine> make_rounds_engine(const Rule& rule, const Body& body, const Periodic& periodic,
                                               const RealOptions& options) {
  const std::string name = rule.rounds->declaration().name;
  if (options.precision == Precision::float32)
    throw InputError(fmt::format("the rule '{}' runs in doubles: --precision float is not for it", name));
  if (options.deform && !rule.rounds->lets_box_deform())
    throw InputError(fmt::format("the rule '{}' takes a box of one size", name));
  if (options.order_seed != 0) throw InputError(fmt::format("the rule '{}' sums in one order, by id", name));
  if (rule.damping.coefficient > 0)
    throw InputError(fmt::format("the rule '{}' has no damping by pairs", name), "leave [damping] out");
  return std::make_unique<RoundsEngine>(rule, body, periodic, options);
}

}  // namespace cuboct
