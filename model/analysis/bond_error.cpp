// SPDX-License-Identifier: MIT
#include "model/analysis/bond_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "model/contract/law.h"

namespace cuboct {
namespace {

constexpr int kStrains = 256;  // of the strains on each side

double largest_strength(const Rule& rule) {
  double largest = 0;
  for (const auto& row : rule.strength) largest = std::max(largest, *std::ranges::max_element(row));
  return largest;
}

// The distance at which a law pulls most, m; 0 where it never pulls.
double peak_of(const PairLaw& law) {
  const double begin = std::max(law.core(), stiffest_rest_distance(law)), end = law.cutoff();
  double peak = 0, most = 0;
  for (int k = 0; k <= 4 * kStrains; ++k) {
    const double r = begin + (end - begin) * k / (4 * kStrains + 1);
    if (-law.force(r) > most) most = -law.force(r), peak = r;
  }
  return peak;
}

class Pairs {
 public:
  Pairs(const Scene& scene, const FixedRule& fixed, const Motion& motion)
      : rule_(scene.rule), fixed_(fixed), motion_(motion), largest_(largest_strength(scene.rule)) {}

  // Of a pair of types; no strain where nothing holds the two together.
  BondError of(int i, int j) const {
    const double rest = motion_.rest_distance, strength = rule_.strength_of(i, j);
    const PairLaw& law = rule_.law_of(i, j);
    const double stiffness = -law.slope(rest) * strength;
    if (!(stiffness > 0) || rest >= law.cutoff()) return {};
    const double lighter = std::min(rule_.mass_of(i), rule_.mass_of(j));
    BondError error;
    // A wave of a speed strains the slower matter more.
    const double slower = motion_.sound_speed / (rest * std::sqrt(stiffness / lighter));
    error.strain = std::min(kMostStrain, motion_.strain * std::max(1.0, slower));
    const double force = at_strain(law, strength, error);
    const Widths& w = fixed_.widths;
    const double edge = fixed_.cell_edge, mass = fixed_.mass, dt = fixed_.dt;
    error.table /= force;
    error.strength = unit(strength) * rest / 2 *
                     std::sqrt((fixed_.damped ? 1.0 : 0.0) + (fixed_.scaled ? 1.0 : 0.0)) / force;
    error.difference =
        stiffness * edge * (std::ldexp(0.5, -w.difference_frac) + std::ldexp(1, -w.position_frac)) / force;
    error.velocity = mass * std::ldexp(edge, -w.velocity_frac() - 1) / (dt * dt * force);
    if (fixed_.damped)
      error.damping = rule_.damping_over_r2(rest) * rest * rest * strength *
                      std::ldexp(edge, -w.relative_velocity_frac) / (dt * force);
    return error;
  }

 private:
  // N/m that a unit of a strength is worth.
  double unit(double strength) const {
    return std::ldexp(fixed_.mass, -fixed_.force.value_frac) / (fixed_.dt * fixed_.dt) * strength / largest_;
  }

  // N: the force of a bond at the strain, by its stiffness or, where less, what the law has at most up to
  // there. Fills the table's largest error, N.
  double at_strain(const PairLaw& law, double strength, BondError& error) const {
    const double rest = motion_.rest_distance, whole = std::ldexp(1.0, 2 * fixed_.widths.difference_frac);
    size_t number = 0;
    while (&rule_.law_at(number) != &law) ++number;
    double most = 0;
    for (int k = -kStrains; k <= kStrains; ++k) {
      const double in_edges = rest * (1 + error.strain * k / kStrains) / fixed_.cell_edge;
      const auto r2 = static_cast<uint64_t>(std::llround(in_edges * in_edges * whole));
      const double r = std::sqrt(static_cast<double>(r2) / whole) * fixed_.cell_edge;
      if (r2 >= fixed_.cutoff2 || r >= law.cutoff()) continue;
      const double exact = law.force(r) * strength;
      const auto entry = static_cast<double>(fixed_.force.at(r2, static_cast<uint32_t>(number)));
      error.table = std::max(error.table, std::abs(entry * unit(strength) * r - exact));
      most = std::max(most, std::abs(exact));
    }
    return std::min(most, -law.slope(rest) * strength * error.strain * rest);
  }

  const Rule& rule_;
  const FixedRule& fixed_;
  const Motion& motion_;
  double largest_;
};

}  // namespace

double BondError::together(double sections, double particles) const {
  return std::sqrt((table * table + strength * strength + damping * damping) / sections +
                   (difference * difference + velocity * velocity) / particles);
}

std::string BondError::largest() const {
  const std::array<std::pair<double, const char*>, 5> parts{{{table, "the force table"},
                                                             {strength, "strengths"},
                                                             {difference, "differences"},
                                                             {velocity, "velocities"},
                                                             {damping, "relative velocities"}}};
  return std::ranges::max_element(parts, {}, &std::pair<double, const char*>::first)->second;
}

BondError bond_error(const Scene& scene, const FixedRule& fixed, const Motion& motion) {
  const Rule& rule = scene.rule;
  BondError worst;
  if (!(motion.strain > 0) || !(motion.rest_distance > 0)) return worst;
  const Pairs pairs(scene, fixed, motion);
  for (size_t i = 0; i < rule.types.size(); ++i)
    for (size_t j = i; j < rule.types.size(); ++j) {
      if (rule.only_touch(static_cast<int>(i), static_cast<int>(j))) continue;
      const BondError of = pairs.of(static_cast<int>(i), static_cast<int>(j));
      if (of.strain > 0 && (worst.strain == 0 || of.together() > worst.together())) worst = of;
    }
  double weakest = 0;
  for (size_t n = 0; n < rule.laws(); ++n)
    if (const double peak = peak_of(rule.law_at(n)); peak > 0) {
      const double stretch = peak / motion.rest_distance - 1;
      weakest = weakest > 0 ? std::min(weakest, stretch) : stretch;
    }
  worst.peak_strain = std::max(0.0, weakest);
  return worst;
}

}  // namespace cuboct
