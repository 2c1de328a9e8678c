// SPDX-License-Identifier: MIT
#include "hw/arch/auto_widths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "model/analysis/motion.h"
#include "model/contract/format_cures.h"
#include "model/contract/state.h"
#include "model/program/rule_program.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

// What suits scenes of large strains, and the least that is taken: products of 18 bits, which small FPGAs
// multiply in one DSP.
constexpr int kLeastPosition = 20, kLeastGuard = 8, kLeastDifference = 16, kLeastRelative = 20;
// Positions are finer than differences by so much: a difference is rounded once more than its ends.
constexpr int kPositionBeyondDifference = 4;
// A unit of a difference kicks by 2^4 units of a velocity or more: with less, the kicks' rounding, not the
// differences', sets how well energy is kept (docs/measured/validation.md, section 1).
constexpr int kKickUnits = 4;
// The widest with which every product and sum of the rule is exact in doubles (emu/lattice/kernel_rule.cpp),
// and a gain times a displacement in 64 bits.
constexpr int kMostPosition = 30, kMostDifference = 24, kMostVelocity = 44, kMostVelocityWithGains = 43,
              kMostRelativeBits = 25, kLeastRelativeFrac = 4;
constexpr int kRelativeRange = -3;  // 1/8 of a cell per step
// Units per 1/accuracy below which a run is warned of: half a unit of so many is five times the accuracy.
constexpr double kFewest = 0.1;
constexpr int kScale = 16, kFilter = 10, kGain = 16;

constexpr const char* kLeft = "as the run had that left the state";

// Whether a text rubs along bonds that last. They may move slowly: nothing says how, and friction of what is
// below a unit of a relative velocity is lost.
bool rubs_for_ever(const Rule& rule) {
  const RuleProgram* text = rule.rounds != nullptr ? rule.rounds->text() : nullptr;
  return text != nullptr && has_reference_bonds(rule) &&
         std::ranges::any_of(text->rounds, [](const ProgramRound& round) {
           return round.pair.reads(RealSource::own_velocity) || round.pair.reads(RealSource::other_velocity);
         });
}

// The least n with 2^-n <= x.
int bits_for(double x) { return static_cast<int>(std::ceil(-std::log2(x) - 1e-9)); }

class Chooser {
 public:
  Chooser(const Scene& scene, double edge, const Widths& asked, double accuracy)
      : scene_(scene), edge_(edge), asked_(asked), accuracy_(accuracy), motion_(motion_of(scene)) {
    const Rule& rule = scene.rule;
    kick_ = motion_.bond_stiffness * rule.dt * rule.dt / rule.heaviest();
    strain_ = motion_.strain * motion_.rest_distance / edge;
    for (const ParticleType& type : rule.types) gains_ = gains_ || type.pd;
    if (const ExactBody* exact = scene.body.exact.get(); exact && exact->cell_edge == edge)
      left_ = exact->widths;
  }

  AutoWidths choose() {
    Widths& w = result_.widths;
    w.filter_frac = asked_.filter_frac != kAutomatic ? asked_.filter_frac : kFilter;
    w.scale_frac = asked_.scale_frac != kAutomatic ? asked_.scale_frac : kScale;
    difference();
    velocity();
    relative_velocity();
    gain();
    w.strength_bits = asked_.strength_bits;  // quantise chooses
    const double force = motion_.bond_stiffness * motion_.strain * motion_.rest_distance;
    result_.half_unit = force > 0 ? 0.5 * accuracy_ * force : std::numeric_limits<double>::infinity();
    return std::move(result_);
  }

 private:
  int take(const char* key, int asked, int wanted, int most, std::string why) {
    const bool says = asked != kAutomatic;
    const int bits = says ? asked : std::min(wanted, most);
    result_.reasons.push_back({key, bits, wanted, says, std::move(why)});
    return bits;
  }

  void difference() {
    Widths& w = result_.widths;
    int wanted = kLeastDifference;
    std::string why = "the least that is taken";
    if (strain_ > 0)
      if (const int bits = bits_for(strain_ * accuracy_); bits > wanted)
        wanted = bits, why = fmt::format("a strain of {:.2g}, by {}, has {:.3g} units", motion_.strain,
                                         motion_.strain_of, 1 / accuracy_);
    const RoundsRule* rounds = scene_.rule.rounds.get();
    if (rounds != nullptr && rounds->text() != nullptr && has_reference_bonds(scene_.rule))
      wanted = kMostDifference, why = "bonds that last open by little";
    if (left_ && left_->difference_frac > wanted) wanted = left_->difference_frac, why = kLeft;
    const int most = asked_.position_frac != kAutomatic ? std::min(kMostDifference, asked_.position_frac)
                                                        : kMostDifference;
    w.difference_frac = take("difference_frac", asked_.difference_frac, wanted, most, why);
    w.position_frac = take(
        "position_frac", asked_.position_frac,
        std::max({kLeastPosition, w.difference_frac + kPositionBeyondDifference,
                  left_ ? left_->position_frac : 0}),
        kMostPosition,
        fmt::format("{} more than differences have, {} or more", kPositionBeyondDifference, kLeastPosition));
  }

  void velocity() {
    Widths& w = result_.widths;
    const double dt = scene_.rule.dt, twice = 2 * std::min(accuracy_, kMostOff);
    int wanted = w.position_frac + kLeastGuard;
    std::string why = "the least that is taken";
    const auto want = [&](int bits, std::string reason) {
      if (bits > wanted) wanted = bits, why = std::move(reason);
    };
    const auto to_accuracy = [&](double per_step, const std::string& what) {
      if (per_step > 0)
        want(bits_for(twice * per_step / edge_), fmt::format("{} to {:.2g}", what, accuracy_));
    };
    to_accuracy(motion_.slowest_imposed * dt,
                fmt::format("an imposed velocity of {:.3g} m/s", motion_.slowest_imposed));
    to_accuracy(motion_.gravity * dt * dt, fmt::format("gravity, {:.3g} m/s^2,", motion_.gravity));
    to_accuracy(motion_.initial_speed * dt,
                fmt::format("initial velocities of {:.3g} m/s", motion_.initial_speed));
    if (kick_ > 0)
      want(w.difference_frac + bits_for(kick_) + kKickUnits,
           fmt::format("a unit of a difference kicks by {} units of a velocity", 1 << kKickUnits));
    if (left_) want(left_->velocity_frac(), kLeft);
    const int most = gains_ ? kMostVelocityWithGains : kMostVelocity;
    // A width that the arch file sets keeps the range that it has with the least guard.
    const int guard = asked_.velocity_bits != kAutomatic
                          ? kLeastGuard
                          : std::clamp(std::min(wanted, most) - w.position_frac, 1, kMostGuard);
    w.guard = take("guard", asked_.guard, std::max(1, wanted - w.position_frac), guard, why);
    const int frac = w.velocity_frac();
    const std::string range = "up to one cell per step";
    w.velocity_bits = take("velocity_bits", asked_.velocity_bits, frac + 1, frac + 1, range);
    w.sum_bits = take("sum_bits", asked_.sum_bits, frac + 1, 48, range);
    w.displacement_bits = take("displacement_bits", asked_.displacement_bits, frac + 1,
                               kMostVelocityWithGains + 1, "up to one cell");
  }

  void relative_velocity() {
    Widths& w = result_.widths;
    const double dt = scene_.rule.dt;
    int wanted = std::min(kLeastRelative, w.velocity_frac());
    std::string why = "the least that is taken";
    if (const double slow = accuracy_ * motion_.strain * motion_.sound_speed * dt / edge_; slow > 0)
      if (const int bits = bits_for(slow); bits > wanted)
        wanted = bits, why = fmt::format("damps what strains by {:.2g}", accuracy_ * motion_.strain);
    int most_bits = kMostRelativeBits;
    if (rubs_for_ever(scene_.rule))
      wanted = w.velocity_frac(), most_bits = kWidestRelative, why = "bonds that last part slowly";
    if (left_ && left_->relative_velocity_frac > wanted) wanted = left_->relative_velocity_frac, why = kLeft;
    double fastest = 4 * motion_.initial_speed;
    for (const ParticleType& type : scene_.rule.types)
      for (const ParticleType& other : scene_.rule.types)
        fastest = std::max(fastest, (type.velocity - other.velocity).norm());
    const int range =
        std::max(kRelativeRange, fastest > 0 ? 1 - bits_for(fastest * dt / edge_) + 1 : kRelativeRange);
    constexpr int kMostRange = kMostRelativeBits - 1 - kLeastRelativeFrac;
    if (range > kMostRange)
      throw InputError(
          fmt::format("at {:.3g} m/s beside one another, particles part by {:.3g} cells in a step: at "
                      "most {} are held",
                      fastest, fastest * dt / edge_, 1 << kMostRange),
          "slower particles, or a shorter step")
          .about({"run.dt", "velocity", "mass"});
    // A width that the arch file sets keeps the range that it has with the least fraction, or this scene's.
    const int most =
        asked_.relative_velocity_bits != kAutomatic
            ? std::min(std::max(kLeastRelative, asked_.relative_velocity_bits - 1 - range), w.velocity_frac())
            : std::min(w.velocity_frac(), most_bits - 1 - range);
    w.relative_velocity_frac =
        take("relative_velocity_frac", asked_.relative_velocity_frac, wanted, most, why);
    w.relative_velocity_bits =
        take("relative_velocity_bits", asked_.relative_velocity_bits, w.relative_velocity_frac + range + 1,
             kWidestRelative, fmt::format("up to {:.3g} cells per step", std::ldexp(1.0, range)));
  }

  void gain() {
    Widths& w = result_.widths;
    const Rule& rule = scene_.rule;
    double least = std::numeric_limits<double>::infinity(), largest = 0;
    for (size_t k = 0; k < rule.types.size(); ++k) {
      const ParticleType& type = rule.types[k];
      const double mass = rule.mass_of(static_cast<int>(k));
      for (const double gain : {type.kp * rule.dt * rule.dt / mass, type.kd * rule.dt / mass})
        if (type.pd && gain > 0) least = std::min(least, gain), largest = std::max(largest, gain);
    }
    int wanted = kGain, most = kMostGainFrac;
    if (largest > 0) {
      wanted = std::max(wanted, bits_for(2 * std::min(accuracy_, kMostOff) * least));
      most = std::min(most, kGainBits - 2 + bits_for(largest * (1 + 1e-4)));
    }
    w.gain_frac =
        take("gain_frac", asked_.gain_frac, wanted, std::max(4, most),
             wanted > kGain ? fmt::format("gains to {:.2g}", accuracy_) : "the least that is taken");
  }

  const Scene& scene_;
  double edge_;
  const Widths& asked_;
  double accuracy_;
  Motion motion_;
  double kick_ = 0;    // cells/step that a bond's stretch of one cell gives the heaviest in a step
  double strain_ = 0;  // cells: what the expected strain stretches a bond by
  bool gains_ = false;
  std::optional<Widths>
      left_;  // of the run that left the state: the same cells, so that its integers carry over
  AutoWidths result_;
};

}  // namespace

AutoWidths auto_widths(const Scene& scene, double edge, const Widths& asked, double accuracy) {
  return Chooser(scene, edge, asked, accuracy > 0 ? accuracy : scene.accuracy).choose();
}

std::vector<std::string> width_warnings(const Scene& scene, double edge, const AutoWidths& taken,
                                        const FixedRule& rule) {
  std::vector<std::string> warnings;
  const Motion motion = motion_of(scene);
  const auto reason = [&](const std::string& key) -> const WidthReason& {
    return *std::find_if(taken.reasons.begin(), taken.reasons.end(),
                         [&](const WidthReason& r) { return r.key == key; });
  };
  // What would do, or that nothing does. `within`: the key that bounds this one, where the arch file sets it.
  const auto cure = [&](const char* key, const char* within, int beyond, int most) {
    const WidthReason &r = reason(key), &bound = reason(within);
    if (r.asked) return fmt::format("{} = {} would do, or \"auto\"", key, r.wanted);
    if (bound.asked) return fmt::format("{} = {} would do, or \"auto\"", within, r.wanted + beyond);
    if (r.wanted <= most)
      return fmt::format("{} = {} would do; \"auto\" ends at {}, with which the lattice engine is fast", key,
                         r.wanted, r.bits);
    return fmt::format("{} of {} would do: {} is the most that engines hold; doubles do (--engine reference)",
                       key, r.wanted, most);
  };
  const auto of_guard = [&] {
    return cure("guard", "velocity_bits", rule.widths.position_frac + 1,
                kMostVelocityFrac - rule.widths.position_frac);
  };
  const double unit = std::ldexp(edge, -rule.widths.velocity_frac());
  const auto off_by = [&](const Vec3& real, const Int3& fixed, double per_unit, double least = 0) {
    const Vec3 kept(static_cast<double>(fixed[0]), static_cast<double>(fixed[1]),
                    static_cast<double>(fixed[2]));
    const double size = std::max(real.norm(), least);
    return size > 0 ? (kept * per_unit - real).norm() / size : 0;
  };
  for (size_t k = 0; k < rule.types.size(); ++k) {
    const ParticleType& type = scene.rule.types[k];
    const double v = off_by(type.velocity, rule.types[k].velocity, unit / rule.dt);
    const double g =
        off_by(type.gravity, rule.types[k].gravity, unit / (rule.dt * rule.dt), type.pull.norm());
    if (v > scene.accuracy)
      warnings.push_back(
          fmt::format("the velocity imposed on '{}' is off by {:.2g} of it: {}", type.name, v, of_guard()));
    if (g > scene.accuracy)
      warnings.push_back(fmt::format("the {} '{}' is off by {:.2g} of it: {}",
                                     type.pull.isZero(0) ? "gravity of" : "force on", type.name, g,
                                     of_guard()));
    const double mass = scene.rule.mass_of(static_cast<int>(k));
    const auto gain = [&](const char* name, double real, int64_t kept) {
      const double off =
          real > 0 ? std::abs(std::ldexp(static_cast<double>(kept), -rule.widths.gain_frac) / real - 1) : 0;
      if (off <= scene.accuracy) return;
      const WidthReason& r = reason("gain_frac");
      warnings.push_back(fmt::format("the gain {} of '{}' is off by {:.2g} of it: {}", name, type.name, off,
                                     r.asked && r.wanted <= gain_frac_of(scene.rule)
                                         ? fmt::format("gain_frac = {} would do, or \"auto\"", r.wanted)
                                         : gains_that_are_kept(scene.rule, k, scene.accuracy)));
    };
    if (type.pd) {
      gain("kp", type.kp * rule.dt * rule.dt / mass, rule.types[k].kp);
      gain("kd", type.kd * rule.dt / mass, rule.types[k].kd);
    }
    if (const double off = std::abs(mass_of(rule, static_cast<int>(k)) / mass - 1); off > scene.accuracy)
      warnings.push_back(
          fmt::format("the mass of '{}' is off by {:.2g} of it: weights have {} fractional bits, "
                      "doubles hold any mass (--engine reference)",
                      type.name, off, kWeightFrac));
  }
  // Units of a difference, and of a velocity, that the expected strain makes.
  const double strain = motion.strain * motion.rest_distance / edge;
  const double kick = motion.bond_stiffness * rule.dt * rule.dt / scene.rule.heaviest() * strain;
  const auto few = [&](double units) { return strain > 0 && units < kFewest / scene.accuracy; };
  if (const double units = std::ldexp(strain, rule.widths.difference_frac); few(units))
    warnings.push_back(fmt::format(
        "a strain of {:.2g}, by {}, has {:.2g} units of a difference: {}", motion.strain, motion.strain_of,
        units, cure("difference_frac", "position_frac", kPositionBeyondDifference, kMostDifference)));
  if (const double units = std::ldexp(kick, rule.widths.velocity_frac()); few(units))
    warnings.push_back(fmt::format("a strain of {:.2g}, by {}, kicks by {:.2g} units of a velocity: {}",
                                   motion.strain, motion.strain_of, units, of_guard()));
  // Damping sees relative velocities: those of a wave of that strain.
  const double relative = motion.strain * motion.sound_speed * rule.dt / edge;
  if (const double units = std::ldexp(relative, rule.widths.relative_velocity_frac);
      rule.damped && few(units))
    warnings.push_back(
        fmt::format("a strain of {:.2g}, by {}, is damped by relative velocities of {:.2g} units: {}",
                    motion.strain, motion.strain_of, units,
                    cure("relative_velocity_frac", "relative_velocity_bits", kRelativeRange + 1,
                         std::min(rule.widths.velocity_frac(), kWidestRelative - 1 - kRelativeRange))));
  return warnings;
}

}  // namespace cuboct
