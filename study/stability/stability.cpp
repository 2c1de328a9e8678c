// SPDX-License-Identifier: MIT
#include "study/stability/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "emu/lattice/run.h"
#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/base/interrupt.h"
#include "model/run/reference_engine.h"
#include "study/sweep/measure_run.h"

namespace cuboct::study {
namespace {

constexpr uint64_t kSeed = 20231;

// Of random displacements, in pitches (or cutoffs): large beside what the arithmetic resolves, and small, as
// laws soften: a mode that is unstable by a part eps of dt stops growing where it has lost 2 eps of its
// stiffness, for the presets at a swing of about 0.3 sqrt(eps) pitches. Doubles resolve 1e-16 of a body;
// floats, of one that is 30 pitches long, 2e-6; the fixed formats 1.5e-5 of a cell in the differences, and
// more where an arch has narrower ones.
double seed_size(Arithmetic arithmetic, const Arch& arch) {
  if (arithmetic == Arithmetic::float64) return 1e-6;
  if (arithmetic == Arithmetic::float32) return 1e-4;
  // Automatic formats are as wide as these, or wider.
  const auto bits = [](int asked, int least) { return asked == kAutomatic ? least : asked; };
  return std::max(2e-4, std::ldexp(8.0, -std::min(bits(arch.widths.position_frac, 20),
                                                  bits(arch.widths.difference_frac, 16))));
}

// The same everywhere: uniform in [-1, 1].
class Dice {
 public:
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
  }

 private:
  uint64_t state_ = kSeed;
};

// Velocities are such that a step at the limit is as long as the displacements.
Scene shaken(const Subject& subject, double dt, double size) {
  Scene scene = subject.scene;
  scene.rule.dt = dt;
  Dice dice;
  for (size_t i = 0; i < scene.body.size(); ++i) {
    const ParticleType& type = scene.rule.types[scene.body.type[i]];
    for (int axis = 0; axis < 3; ++axis) {
      const double x = size * dice.next(), v = size * dice.next() / subject.limit.dt;
      if (type.imposed[axis]) continue;
      scene.body.x[i][axis] += x;
      scene.body.v[i][axis] += v;
      if (!scene.body.u.empty()) scene.body.u[i][axis] += x;
    }
  }
  return scene;
}

// The largest |y| per step, out of the displacements w of each step, whatever their unit.
class Flips {
 public:
  explicit Flips(size_t particles) : w1_(particles, Vec3::Zero()), w2_(particles, Vec3::Zero()) {}
  void add(uint32_t i, const Vec3& w) {
    if (seen_ >= 2) most_ = std::max(most_, (w - 2 * w1_[i] + w2_[i]).squaredNorm());
    w2_[i] = w1_[i], w1_[i] = w;
  }
  void end_step() {
    if (seen_++ >= 2) sizes_.push_back(std::sqrt(most_));
    most_ = 0;
  }
  const std::vector<double>& sizes() const { return sizes_; }

 private:
  std::vector<Vec3> w1_, w2_;
  std::vector<double> sizes_;
  double most_ = 0;
  int seen_ = 0;
};

constexpr size_t kEarly = 8;  // steps whose largest flip is the start

// Judges the sizes of a run as they come. `seed`: of the random displacements per axis, in the unit of w.
class Judge {
 public:
  Judge(double seed, double resolution)
      : bound_(4 * 5 * std::sqrt(3.0) * seed), most_(std::max(20.0, 4 / std::sqrt(8 * resolution))) {}

  // A growth beyond what a stable mode swings to.
  std::optional<Trial> outgrown(const std::vector<double>& sizes) const {
    if (sizes.empty() || !(sizes.back() > most_ * start(sizes))) return std::nullopt;
    return Trial{TrialVerdict::unstable,
                 fmt::format("motion that flips at each step grew {:.0f}-fold in {} steps",
                             sizes.back() / start(sizes), sizes.size() + 2)};
  }
  Trial at_end(const std::vector<double>& sizes) const {
    const size_t quarter = sizes.size() / 4;
    const double second = *std::max_element(sizes.begin() + quarter, sizes.begin() + 2 * quarter);
    const double last = *std::max_element(sizes.end() - quarter, sizes.end());
    if (last > 3 * second && last > start(sizes))
      return {TrialVerdict::unstable,
              fmt::format("motion that flips at each step grew {:.1f}-fold from the second "
                          "quarter of {} steps to the last",
                          last / second, sizes.size() + 2)};
    return {TrialVerdict::stable, ""};
  }

 private:
  // Far beyond the limit the first steps grow as well: no more counts than a stable run can start with, which
  // is |y| < 4 |w|, |w| < |v dt| + dt^2 |K x| < |v dt| + 4 |x|, with v dt and x below `seed` along each axis.
  // And far below it, where y is no flip but the little that a smooth motion changes, formats may round it to
  // nothing at first: no less counts than a part of that.
  double start(const std::vector<double>& sizes) const {
    const auto end = sizes.begin() + static_cast<ptrdiff_t>(std::min(kEarly, sizes.size()));
    return std::clamp(*std::max_element(sizes.begin(), end), 0.05 * bound_, bound_);
  }
  double bound_, most_;
};

// Of an engine that begins with `start`: the way of each step in real numbers, the velocity in integers.
Trial watch(Engine& run, const Body& start, const Judge& judge, uint64_t steps) {
  Flips flips(start.size());
  std::vector<Vec3> before = start.x;
  for (uint64_t n = 0; n < steps; ++n) {
    if (interrupted()) throw Interrupted();
    try {
      run.advance(1);
    } catch (const std::runtime_error& error) {
      return {TrialVerdict::unstable, error.what()};
    }
    if (const Body* body = run.saved_body())
      for (uint32_t i = 0; i < body->size(); ++i) {
        flips.add(i, body->x[i] - before[i]);
        before[i] = body->x[i];
      }
    else
      run.for_each_slot([&](const Particle& p) {
        flips.add(p.id, Vec3(static_cast<double>(p.v[0]), static_cast<double>(p.v[1]),
                             static_cast<double>(p.v[2])));
      });
    flips.end_step();
    if (const auto trial = judge.outgrown(flips.sizes())) return *trial;
  }
  return judge.at_end(flips.sizes());
}

Trial try_reference(const Scene& scene, const Method& method, const Judge& judge, uint64_t steps) {
  const RealOptions options{
      method.integrator, method.arithmetic == Arithmetic::float32 ? Precision::float32 : Precision::float64,
      method.threads};
  ReferenceEngine engine(scene, scene.body, options, scene.rule.cutoff());
  return watch(engine, scene.body, judge, steps);
}

Trial try_lattice(Scene scene, Arch arch, const Method& method, double resolution, double seed,
                  uint64_t steps) {
  // A body under pressure has more particles in a node than the machine may be built for; no bit depends on
  // it.
  if (arch.capacity != kAutomatic) arch.capacity = std::max(arch.capacity, 32);
  // The formats are those of the scene without the forces that hold a stretched body still.
  std::vector<Vec3> holding;
  for (ParticleType& type : scene.rule.types) holding.push_back(std::exchange(type.gravity, Vec3::Zero()));
  arch = settled(scene, arch);
  for (size_t k = 0; k < holding.size(); ++k) scene.rule.types[k].gravity = holding[k];
  // Forces that hold a stretched body still, where the format of gravity would round them to less than 1 %:
  // they are less than a difference's rounding does.
  const double unit =
      std::ldexp(scene.rule.cutoff(), -arch.widths.velocity_frac()) / (scene.rule.dt * scene.rule.dt);
  for (ParticleType& type : scene.rule.types)
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(type.gravity[axis]) < 128 * unit) type.gravity[axis] = 0;
  std::optional<Plan> plan;
  try {
    plan = plan_of(scene, arch, CellForm::any);
  } catch (const InputError& error) {
    return {TrialVerdict::refused, parts_of(error).message};
  }
  const FixedRule& rule = plan->rule;
  const Judge judge(std::ldexp(seed / rule.edges().shortest(), rule.widths.velocity_frac()), resolution);
  emu::LatticeChoice choice;
  choice.engine.threads = method.threads;
  return watch(*emu::lattice_kind(scene, *plan, choice).make(nullptr, false), scene.body, judge, steps);
}

}  // namespace

Trial try_step(const Subject& subject, const Arch& arch, const Method& method, double dt, double resolution,
               uint64_t steps) {
  if (method.arithmetic == Arithmetic::fixed && method.integrator != Integrator::semi_implicit_euler)
    throw InputError("the fixed rule is semi-implicit Euler");
  const double seed = seed_size(method.arithmetic, arch) * length_unit(subject.scene);
  Scene scene = shaken(subject, dt, seed);
  steps = std::max<uint64_t>(steps, 4 * kEarly + 2);
  return method.arithmetic == Arithmetic::fixed
             ? try_lattice(std::move(scene), arch, method, resolution, seed, steps)
             : try_reference(scene, method, Judge(seed, resolution), steps);
}

uint64_t steps_to_tell(const Limit& limit, double resolution) {
  // Of the first mode at its limit, dt c = 2 share and dt^2 k = 4 (1 - share); at (1 + resolution) dt it has
  // the root z < -1.
  const double a = 1 + resolution;
  const double c = 2 * limit.damping_share * a, k = 4 * (1 - limit.damping_share) * a * a;
  const double p = k + c - 2, q = 1 - c;
  const double z = -(p + std::sqrt(std::max(0.0, p * p - 4 * q))) / 2;
  // Growth by exp(24) in all: the mode is one of thousands, and must stand out by half time.
  return static_cast<uint64_t>(std::clamp(24 / std::log(-z), 100.0, 4000.0));
}

MeasuredLimit measured_limit(const Subject& subject, const Arch& arch, const Method& method,
                             double resolution) {
  const double guess = subject.limit.dt;
  MeasuredLimit out;
  out.steps = steps_to_tell(subject.limit, resolution);
  const auto stable_at = [&](double dt) {
    const Trial trial = try_step(subject, arch, method, dt, resolution, out.steps);
    ++out.trials;
    if (trial.verdict == TrialVerdict::stable) {
      out.stable = dt;
      return true;
    }
    out.unstable = dt, out.sign = trial.sign, out.refused = trial.verdict == TrialVerdict::refused;
    return false;
  };
  // The bracket's ends move away from the guess until they differ.
  constexpr double kFarthest = 1000;
  for (double width = 8 * resolution; !stable_at(guess / (1 + width)); width *= 4) {
    if (width < kFarthest) continue;
    if (out.refused) throw InputError(out.sign);
    throw std::runtime_error(fmt::format("unstable even at {:.3g} s: {}", out.unstable, out.sign));
  }
  for (double width = 8 * resolution; out.unstable == 0 && stable_at(guess * (1 + width)); width *= 4)
    if (width > kFarthest) throw std::runtime_error(fmt::format("stable even at {:.3g} s", out.stable));
  while (out.unstable - out.stable > resolution * out.stable) stable_at((out.stable + out.unstable) / 2);
  return out;
}

}  // namespace cuboct::study
