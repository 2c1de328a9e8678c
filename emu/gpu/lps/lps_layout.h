// SPDX-License-Identifier: MIT
// A body's bonds as a device reads them, made on the host.
//
// Bonds of a packing are of few kinds: as many as there are neighbours, and more at surfaces, where weighted
// volumes differ. So a bond holds the other particle and the number of its kind, and no vector of its own.
// Bonds of 32 particles stand in turn, the first of each, the second of each, ...: 32 threads read them in a
// row.
#pragma once

#include <cstdint>
#include <vector>

#include "model/rules/lps_terms.h"

namespace cuboct::gpu {

inline constexpr uint32_t kLpsLanes = 32;

// Powers of two, so that no bit is lost: lengths of about a horizon, volumes of about a particle's and times
// of about a step are then near 1, and floats reach from atoms to dams.
struct LpsUnits {
  double length = 1, volume = 1, pressure = 1, time = 1;  // m, m^3, Pa, s
};
LpsUnits lps_units(const LpsMaterial& material, double dt);

// What a bond holds and never changes, in those units.
struct LpsKind {
  double r[3] = {}, length = 0;
  double weight = 0;    // influence times the far end's volume
  double pull = 0;      // (C2 mu/2)(1/m_i + 1/m_j)
  double critical = 0;  // stretch; infinite of a bond that never breaks
  double volume = 0;    // of the far end
};

struct LpsLayout {
  LpsUnits units;
  std::vector<LpsKind> kinds;
  std::vector<uint32_t> slice;  // [particle / 32]: where its bonds' slots begin
  std::vector<uint32_t> count;  // [particle]: its bonds
  std::vector<uint32_t> other;  // [slot]
  std::vector<uint32_t> kind;   // [slot]
  uint64_t slots() const { return other.size(); }
  // Of a particle's k-th bond.
  uint64_t slot(size_t particle, uint32_t k) const {
    return slice[particle / kLpsLanes] + uint64_t{k} * kLpsLanes + particle % kLpsLanes;
  }
};

// Two bonds are of one kind where nothing of theirs differs by more than 1e-12. InputError where there are
// more than 2^32 slots.
LpsLayout lps_layout(const LpsTerms& terms, double dt);

}  // namespace cuboct::gpu
