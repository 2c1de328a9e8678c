// SPDX-License-Identifier: MIT
#include "synth/stage_time.h"

#include <fmt/format.h>

#include <cmath>

namespace cuboct::synth {
namespace {

// In two digits at most.
double rounded(double seconds) {
  const double unit = std::pow(10, std::max(0.0, std::floor(std::log10(seconds)) - 1));
  return std::round(seconds / unit) * unit;
}

}  // namespace

std::string synthesis_time(Family family, uint64_t bits) {
  constexpr double kLeast = 4, kBit = 1.25e-3, kBitAsic = 1.1e-2;  // s
  const double seconds = kLeast + (family == Family::asic ? kBitAsic : kBit) * static_cast<double>(bits);
  const double low = rounded(seconds / 2), high = rounded(2 * seconds);
  if (low < 60) return fmt::format("{:.0f} to {:.0f} s", low, high);
  return fmt::format("{:.0f} to {:.0f} min", std::floor(low / 60), std::ceil(high / 60));
}

}  // namespace cuboct::synth
