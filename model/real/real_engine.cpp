// SPDX-License-Identifier: MIT
#include "model/real/real_engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "model/base/error.h"
#include "model/base/parallel.h"
#include "model/real/rounds_engine.h"

namespace cuboct {
namespace {

// Threads for fewer particles would cost more than they bring.
constexpr size_t kParticlesPerThread = 64;

// Lists are planned anew when the first steps have shown how far particles go, and now and then later.
constexpr uint64_t kFirstPlan = 20, kPlanEvery = 1000;

uint64_t mixed(uint64_t x) {  // splitmix64, G. Steele et al., OOPSLA 2014
  x += 0x9e3779b97f4a7c15;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
  x = (x ^ x >> 27) * 0x94d049bb133111eb;
  return x ^ x >> 31;
}

// What a type does to its particles.
template <class Real>
struct Push {
  Real mass, gravity[3], velocity[3], kp, kd;
  bool imposed[3], pd;
  Push(const ParticleType& type, double kg)
      : mass(static_cast<Real>(kg)),
        kp(static_cast<Real>(type.kp)),
        kd(static_cast<Real>(type.kd)),
        pd(type.pd) {
    for (int axis = 0; axis < 3; ++axis) {
      gravity[axis] = static_cast<Real>(type.gravity[axis]);
      velocity[axis] = static_cast<Real>(type.velocity[axis]);
      imposed[axis] = type.imposed[axis];
    }
  }
};

template <class Real>
class Engine final : public RealEngine {
 public:
  Engine(const Rule& rule, const Body& body, const Periodic& periodic, const RealOptions& options)
      : rule_cutoff_(rule.cutoff()),
        force_(rule, periodic),
        threads_(static_cast<int>(std::clamp<size_t>(body.size() / kParticlesPerThread, 1,
                                                     static_cast<size_t>(std::max(1, options.threads))))),
        list_(rule.cutoff(), periodic, margin(periodic), pair_lanes<Real>(), threads_),
        options_(options),
        dt_(rule.dt),
        particles_(body.size()),
        box_(periodic),
        listed_box_(periodic) {
    for (const ParticleType& type : rule.types) {
      pushes_.emplace_back(type, rule.mass_of(static_cast<int>(pushes_.size())));
      materials_.push_back(static_cast<Real>(type.material));
      pd_ = pd_ || type.pd;
    }
    x_ = packed(body.x);
    v_ = packed(body.v);
    if (pd_) u_ = packed(body.u);
    type_ = body.type;
    rank_.resize(particles_);
    for (size_t i = 0; i < particles_; ++i) {
      x_[4 * i + 3] = materials_[type_[i]];
      rank_[i] = static_cast<uint32_t>(i);
    }
    double fastest = 0;
    for (const Vec3& v : body.v) {
      fastest = std::max(fastest, v.norm());
      fastest_ = std::max(fastest_, static_cast<Real>(v.cwiseAbs().maxCoeff()));
    }
    relist(0, true, std::isfinite(fastest) ? fastest * dt_ : 0);
    plan_in_ = kFirstPlan;
    if (options.integrator == Integrator::velocity_verlet) evaluate(0);
  }

  void step(uint64_t number) override {
    if (options_.integrator == Integrator::semi_implicit_euler) {
      evaluate(number);
      carry(number + 1);
      move<true>(dt_, dt_, number);
    } else {
      carry(number + 1);
      move<true>(dt_ / 2, dt_, number);
      evaluate(number);
      move<false>(dt_ / 2, 0, number);
    }
  }

  void read(Body& body) const override {
    unpack(x_, body.x);
    unpack(v_, body.v);
    if (pd_) unpack(u_, body.u);
  }
  void place(const Body& body, uint64_t) override {
    Real farthest2 = 0;
    for (size_t i = 0; i < particles_; ++i) {
      Real moved2 = 0;
      for (size_t axis = 0, k = 4 * size_t{rank_[i]}; axis < 3; ++axis, ++k) {
        x_[k] = static_cast<Real>(body.x[i][axis]);
        v_[k] = static_cast<Real>(body.v[i][axis]);
        if (pd_) u_[k] = static_cast<Real>(body.u[i][axis]);
        moved2 += (x_[k] - listed_[k]) * (x_[k] - listed_[k]);
      }
      farthest2 = std::max(farthest2, moved2);
      if (!std::isfinite(moved2)) farthest2 = std::numeric_limits<Real>::infinity();
    }
    keep_listed(farthest2, !std::isfinite(farthest2), 0);
  }
  std::vector<Vec3> forces() const override {
    std::vector<Real> f(x_.size());
    sum(f);
    std::vector<Vec3> by_id(particles_);
    unpack(f, by_id);
    return by_id;
  }
  double largest_speed() const override { return static_cast<double>(fastest_); }
  const NearList& list() const override { return list_; }
  uint64_t lists_made() const override { return lists_made_; }

 private:
  // Differences across a box and the box itself are rounded, each by half an epsilon of its size or less.
  double margin(const Periodic& periodic) const {
    return 8 * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
           (rule_cutoff_ + periodic.extent.maxCoeff());
  }
  // The particles, and where the list was made, go with the box to that of a step.
  void carry(uint64_t step) {
    if (!options_.deform) return;
    const Periodic next = options_.deform->at(step);
    const BoxStretch stretch(box_, next);
    for (std::vector<Real>* four : {&x_, &listed_})
      for (size_t s = 0; s < particles_; ++s)
        for (int axis = 0; axis < 3; ++axis) {
          Real& x = (*four)[4 * s + static_cast<size_t>(axis)];
          x = static_cast<Real>(stretch.origin[axis] + stretch.ratio[axis] * (x - stretch.origin[axis]));
        }
    box_ = next;
    force_.set_box(next);
    list_.set_box(next, margin(next));
  }
  // m, that a particle may go from where it was listed.
  double allowed() const {
    if (!options_.deform) return list_.skin() / 2;
    return allowed_motion(rule_cutoff_, rule_cutoff_ + list_.skin(), listed_box_, box_);
  }
  static std::vector<Real> packed(const std::vector<Vec3>& by_id) {
    std::vector<Real> four(4 * by_id.size());
    for (size_t i = 0; i < by_id.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) four[4 * i + axis] = static_cast<Real>(by_id[i][axis]);
    return four;
  }
  void unpack(const std::vector<Real>& four, std::vector<Vec3>& by_id) const {
    for (size_t i = 0; i < particles_; ++i)
      for (int axis = 0; axis < 3; ++axis)
        by_id[i][axis] = static_cast<double>(four[4 * size_t{rank_[i]} + axis]);
  }

  void sum(std::vector<Real>& f) const {
    const std::vector<PairRows>& parts = list_.parts();
    for_each_part(parts.size(), threads_,
                  [&](size_t p, int) { pair_forces(force_, parts[p], x_.data(), v_.data(), f.data()); });
  }
  void evaluate(uint64_t number) {
    if (options_.order_seed != 0) shuffle(number);
    sum(f_);
    // Velocity Verlet kicks twice with these forces: they keep the velocities of now, as the damping does.
    if (pd_) add_holds();
  }
  void add_holds() {
    for_each_range(
        particles_, 1,
        [&](size_t begin, size_t end) {
          for (size_t s = begin; s < end; ++s) {
            const Push<Real>& push = pushes_[type_[s]];
            if (!push.pd) continue;
            for (size_t k = 4 * s; k < 4 * s + 3; ++k)
              f_[k] -= push.kp * u_[k] + push.kd * (v_[k] - push.velocity[k - 4 * s]);
          }
        },
        threads_);
  }

  // Fisher and Yates, lane by lane; what fills a lane's rows is shuffled among them.
  void shuffle(uint64_t number) {
    const size_t lanes = pair_lanes<Real>();
    const std::span<const uint32_t> ids = list_.order();
    for (PairRows& part : list_.parts())
      for (size_t g = 0; g + 1 < part.begin.size(); ++g)
        for (size_t lane = 0; lane < lanes; ++lane) {
          const size_t slot = (part.first_group + g) * lanes + lane;
          if (slot >= particles_) continue;
          uint64_t dice = mixed(mixed(options_.order_seed + number * 0x100000001b3) + ids[slot]);
          uint32_t* const first = part.entry.data() + part.begin[g] * lanes + lane;
          for (size_t k = part.begin[g + 1] - part.begin[g]; k > 1; --k) {
            dice = mixed(dice);
            std::swap(first[(k - 1) * lanes], first[dice % k * lanes]);
          }
        }
  }

  // v += a * kick with imposed velocities; then u and x by v * drift.
  template <bool kDrifts>
  void move(double kick, double drift, uint64_t number) {
    const Real kick_dt = static_cast<Real>(kick), drift_dt = static_cast<Real>(drift);
    Real farthest2 = 0, fastest = fastest_;
    bool lost = false;
    std::mutex joining;
    const auto move_range = [&](size_t begin, size_t end) {
      Real farthest2_here = 0, fastest_here = 0;
      bool lost_here = false;
      for (size_t s = begin; s < end; ++s) {
        const Push<Real>& push = pushes_[type_[s]];
        Real* const x = &x_[4 * s];
        Real* const v = &v_[4 * s];
        const Real* const f = &f_[4 * s];
        Real moved2 = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const Real a = f[axis] / push.mass + push.gravity[axis];
          const Real free = v[axis] + a * kick_dt;
          v[axis] = push.imposed[axis] ? push.velocity[axis] : free;
          fastest_here = std::max(fastest_here, std::abs(v[axis]));
          if (!kDrifts) continue;
          if (push.pd) u_[4 * s + axis] += (v[axis] - push.velocity[axis]) * drift_dt;
          x[axis] += v[axis] * drift_dt;
          const Real moved = x[axis] - listed_[4 * s + axis];
          moved2 += moved * moved;
        }
        if (!kDrifts) continue;
        farthest2_here = std::max(farthest2_here, moved2);
        lost_here = lost_here || !std::isfinite(moved2);
      }
      const std::lock_guard lock(joining);
      farthest2 = std::max(farthest2, farthest2_here);
      fastest = std::max(fastest, fastest_here);
      lost = lost || lost_here;
    };
    for_each_range(particles_, 1, move_range, threads_);
    fastest_ = fastest;
    if (kDrifts) keep_listed(farthest2, lost, number);
  }

  // A new list where a particle has gone too far since the last one.
  void keep_listed(Real farthest2, bool lost, uint64_t number) {
    ++steps_on_list_;
    const double farthest = std::sqrt(static_cast<double>(farthest2));
    const bool due = --plan_in_ == 0;
    if (due) plan_in_ = kPlanEvery;
    if (lost || farthest > allowed() || due)
      relist(number, due, farthest / static_cast<double>(steps_on_list_));
  }

  void relist(uint64_t number, bool plan, double speed) {
    std::vector<Vec3> x(particles_);
    unpack(x_, x);
    try {
      if (plan) list_.plan(x, speed);
      list_.build(x);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("step {}: {}; is dt too long?", number, error.what()));
    }
    ++lists_made_;
    steps_on_list_ = 0;
    const std::span<const uint32_t> order = list_.order();
    const auto sorted = [&](std::vector<Real>& four) {
      std::vector<Real> to(4 * list_.slots());
      for (size_t s = 0; s < particles_; ++s) std::copy_n(&four[4 * size_t{rank_[order[s]]}], 4, &to[4 * s]);
      four.swap(to);
    };
    sorted(x_);
    sorted(v_);
    if (pd_) sorted(u_);
    std::vector<uint8_t> types(particles_);
    for (size_t s = 0; s < particles_; ++s) types[s] = type_[rank_[order[s]]];
    type_.swap(types);
    for (size_t s = 0; s < particles_; ++s) rank_[order[s]] = static_cast<uint32_t>(s);
    listed_ = x_;
    listed_box_ = box_;
    f_.resize(x_.size());
  }

  const double rule_cutoff_;  // m
  PairForce<Real> force_;
  const int threads_;
  NearList list_;
  const RealOptions options_;
  const double dt_;
  const size_t particles_;
  Periodic box_, listed_box_;  // of now, and of when the list was made
  bool pd_ = false;
  std::vector<Push<Real>> pushes_;  // [type]
  std::vector<Real> materials_;     // [type]
  // By slot, four numbers each: coordinates, and in x the material.
  std::vector<Real> x_, v_, u_, f_;  // f_: of pairs and of holds
  std::vector<Real> listed_;         // x when the list was made
  std::vector<uint8_t> type_;
  std::vector<uint32_t> rank_;  // [id]: slot
  Real fastest_ = 0;            // m/s, along an axis, since the start
  uint64_t steps_on_list_ = 0, plan_in_ = kPlanEvery, lists_made_ = 0;
};

}  // namespace

std::unique_ptr<RealEngine> make_real_engine(const Rule& rule, const Body& body, const Periodic& periodic,
                                             const RealOptions& options) {
  if (rule.rounds != nullptr) return make_rounds_engine(rule, body, periodic, options);
  if (options.precision == Precision::float32 && options.deform)
    throw InputError("floats do not hold the strain of one step: a box that deforms needs doubles",
                     "leave --precision out");
  if (options.precision == Precision::float32)
    return std::make_unique<Engine<float>>(rule, body, periodic, options);
  return std::make_unique<Engine<double>>(rule, body, periodic, options);
}

}  // namespace cuboct
