// SPDX-License-Identifier: MIT
#include "model/contract/format_cures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cuboct {
namespace {

// To three figures, never above, or never below.
double rounded(double value, double (*way)(double)) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2);
  return way(value / unit) * unit;
}
double below(double value) {
  return rounded(value, [](double v) { return std::floor(v); });
}
double above(double value) {
  return rounded(value, [](double v) { return std::ceil(v); });
}

}  // namespace

std::string dt_that_holds(double dt, double value, double limit, int power) {
  return fmt::format("a dt of at most {:.3g} s holds it",
                     below(dt * std::pow(0.999 * limit / std::abs(value), 1.0 / power)));
}

std::string guard_that_keeps(double whole, const Widths& widths) {
  const int frac = static_cast<int>(std::ceil(-std::log2(2 * kMostOff * std::abs(whole))));
  const int guard = frac - widths.position_frac;
  if (guard > kMostGuard || frac > kMostVelocityFrac) return kDoublesHold;
  return fmt::format("guard = {} in the arch file keeps it", guard);
}

int gain_frac_of(const Rule& rule) {
  double largest = 0;
  for (size_t k = 0; k < rule.types.size(); ++k) {
    const ParticleType& type = rule.types[k];
    const double per_step = rule.dt / rule.mass_of(static_cast<int>(k));
    if (type.pd) largest = std::max({largest, type.kp * per_step * rule.dt, type.kd * per_step});
  }
  const double holds = std::ldexp(1.0, kGainBits - 1) - 0.5;
  return largest > 0 ? std::min(kMostGainFrac, static_cast<int>(std::floor(std::log2(holds / largest))))
                     : kMostGainFrac;
}

std::string gains_that_are_kept(const Rule& rule, size_t type, double most_off) {
  const double least = std::ldexp(0.5 / most_off, -gain_frac_of(rule)),
               kd = least * rule.mass_of(static_cast<int>(type)) / rule.dt, kp = kd / rule.dt;
  std::string kept;
  const auto add = [&](const char* name, double gain, double from, const char* unit) {
    if (gain > 0 && gain < from)
      kept += fmt::format("{}{} = {:.3g} {}", kept.empty() ? "" : " and ", name, above(from), unit);
  };
  add("kp", rule.types[type].kp, kp, "N/m");
  add("kd", rule.types[type].kd, kd, "kg/s");
  if (kept.empty()) return fmt::format("gain_frac = {} in the arch file keeps it", gain_frac_of(rule));
  return fmt::format("a constraint of its own with {}, or more, for '{}' holds it; {}", kept,
                     rule.types[type].name, kDoublesHold);
}

std::string kicks_that_fit(const Widths& widths, int missing, double dt) {
  std::string cures;
  const auto add = [&](const char* key, int bits) {
    cures += fmt::format("{}{} = {}", cures.empty() ? "" : " or ", key, bits);
  };
  if (widths.strength_bits + missing <= kWidestStrength) add("strength_bits", widths.strength_bits + missing);
  if (widths.guard > missing) add("guard", widths.guard - missing);
  if (!cures.empty()) return cures + " in the arch file holds it";
  return dt_that_holds(dt, std::ldexp(1.0, missing), 1, 2);
}

std::string damping_that_fits(const Widths& widths, int missing) {
  if (widths.relative_velocity_frac + missing <= widths.velocity_frac() &&
      widths.relative_velocity_bits + missing <= kWidestRelative)
    return fmt::format("relative_velocity_frac = {}, relative_velocity_bits = {} in the arch file hold it",
                       widths.relative_velocity_frac + missing, widths.relative_velocity_bits + missing);
  return fmt::format("damping of at most {:.3g} of this holds it", std::ldexp(1.0, -missing));
}

}  // namespace cuboct
