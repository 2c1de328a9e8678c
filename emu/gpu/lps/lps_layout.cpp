// SPDX-License-Identifier: MIT
#include "emu/gpu/lps/lps_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "model/base/error.h"

namespace cuboct::gpu {
namespace {

constexpr double kGrain = 1e-12;  // below it two numbers are one: coordinates of a packing are rounded

using Key = std::array<int64_t, 6>;
struct KeyHash {
  size_t operator()(const Key& key) const {
    uint64_t hash = 0;
    for (const int64_t k : key) {
      hash = (hash ^ static_cast<uint64_t>(k)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

double power_of_two(double value) { return std::exp2(std::ilogb(value)); }

// Numbers the kinds in the order in which they come.
class Kinds {
 public:
  Kinds(const LpsTerms& terms, const LpsUnits& units)
      : terms_(terms),
        units_(units),
        half_(terms.material().stretch_factor() / 2 / units.pressure),
        inverse_unit_(units.length * units.length * units.volume) {}

  uint32_t of(size_t particle, uint64_t bond) {
    const LpsKind kind = make(particle, bond);
    const auto [at, fresh] = numbers_.try_emplace(key_of(kind), static_cast<uint32_t>(kinds_.size()));
    if (fresh) kinds_.push_back(kind);
    return at->second;
  }
  std::vector<LpsKind> take() { return std::move(kinds_); }

 private:
  LpsKind make(size_t i, uint64_t b) const {
    const Vec3 r = terms_.reference().vector[b] / units_.length;
    const std::vector<double>& inverse = terms_.inverse_weighted();
    LpsKind kind;
    for (int a = 0; a < 3; ++a) kind.r[a] = r[a];
    kind.length = r.norm();
    kind.weight = terms_.weights()[b] / units_.volume;
    kind.volume = terms_.volumes()[b] / units_.volume;
    kind.pull = half_ * ((inverse[i] + inverse[terms_.reference().other[b]]) * inverse_unit_);
    kind.critical =
        terms_.breaks(b) ? terms_.material().critical_stretch : std::numeric_limits<double>::infinity();
    return kind;
  }
  // All numbers are of order 1. Weights of one length and volume are equal.
  Key key_of(const LpsKind& kind) const {
    const auto whole = [](double value) { return std::llround(value / kGrain); };
    return {whole(kind.r[0]),   whole(kind.r[1]),         whole(kind.r[2]),
            whole(kind.weight), whole(kind.pull / half_), std::isinf(kind.critical) ? 1 : 0};
  }

  const LpsTerms& terms_;
  const LpsUnits units_;
  const double half_, inverse_unit_;
  std::vector<LpsKind> kinds_;
  std::unordered_map<Key, uint32_t, KeyHash> numbers_;
};

void check_slots(uint64_t slots) {
  if (slots > std::numeric_limits<uint32_t>::max())
    throw InputError(fmt::format("{} bonds are more than a device numbers, {}", slots,
                                 std::numeric_limits<uint32_t>::max()));
}

}  // namespace

LpsUnits lps_units(const LpsMaterial& m, double dt) {
  return {power_of_two(m.horizon), power_of_two(m.volume), power_of_two(m.stretch_factor()),
          power_of_two(dt)};
}

LpsLayout lps_layout(const LpsTerms& terms, double dt) {
  const ReferenceBonds& bonds = terms.reference();
  const size_t n = bonds.particles();
  LpsLayout layout;
  layout.units = lps_units(terms.material(), dt);
  layout.count.resize(n);
  uint64_t slots = 0;
  for (size_t first = 0; first < n; first += kLpsLanes) {
    check_slots(slots);
    layout.slice.push_back(static_cast<uint32_t>(slots));
    uint32_t most = 0;
    for (size_t i = first; i < std::min(n, first + kLpsLanes); ++i) {
      layout.count[i] = static_cast<uint32_t>(bonds.end(i) - bonds.begin(i));
      most = std::max(most, layout.count[i]);
    }
    slots += uint64_t{most} * kLpsLanes;
  }
  check_slots(slots);
  layout.other.assign(slots, 0), layout.kind.assign(slots, 0);
  Kinds kinds(terms, layout.units);
  for (size_t i = 0; i < n; ++i)
    for (uint32_t k = 0; k < layout.count[i]; ++k) {
      const uint64_t bond = bonds.begin(i) + k, slot = layout.slot(i, k);
      layout.other[slot] = bonds.other[bond], layout.kind[slot] = kinds.of(i, bond);
    }
  layout.kinds = kinds.take();
  return layout;
}

}  // namespace cuboct::gpu
