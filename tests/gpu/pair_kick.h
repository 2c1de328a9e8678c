// SPDX-License-Identifier: MIT
// A pair's kick as the engines sum it.
#pragma once

#include "emu/gpu/real/real_rule.h"

namespace cuboct::gpu {

// Adds what j does to i to `sum`; tells whether j is inside the cutoff. Arguments: pair_factor.
template <LawKind kKind, bool kDamped, bool kScaled, class Roots = FastRoots, class Real>
bool add_pair_kick(const RealRule<Real>& rule, const Real* cache, const Real d[3], const Real w[3],
                   int type_i, int type_j, Real sum[3]) {
  Real factor;
  const bool inside = pair_factor<kKind, kDamped, kScaled, Roots>(rule, cache, d, w, type_i, type_j, factor);
  add_kick(factor, d, sum);
  return inside;
}

}  // namespace cuboct::gpu
