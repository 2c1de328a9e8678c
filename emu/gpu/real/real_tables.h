// SPDX-License-Identifier: MIT
// Makes a RealRule of a Rule, and owns its arrays on the host.
#pragma once

#include <vector>

#include "emu/gpu/real/real_rule.h"
#include "model/contract/rule.h"

namespace cuboct::gpu {

template <class Real>  // float or double
struct RealTables {
  // InputError where the law has no closed form, or its force at its core is beyond the range of a Real.
  explicit RealTables(const Rule& rule);

  std::vector<Real> cache, strength;
  std::vector<RealType<Real>> types;
  // One unit of a RealRule in SI.
  double length = 0;    // m: the cutoff
  double velocity = 0;  // m/s: a cutoff per step
  double force = 0;     // N: the lightest mass * velocity per step

  // The rule over these arrays, or over copies of them elsewhere (a device; 16-byte aligned).
  RealRule<Real> rule() const { return rule(cache.data(), strength.data(), types.data()); }
  RealRule<Real> rule(const Real* cache_copy, const Real* strength_copy,
                      const RealType<Real>* types_copy) const {
    RealRule<Real> view = rule_;
    view.cache = cache_copy;
    view.strength = strength_copy;
    view.types = types_copy;
    return view;
  }

 private:
  RealLaw<Real> take_law(const PairLaw& law);
  template <class Piece, class Coefficients>
  void take_pieces(RealLaw<Real>& terms, const std::vector<Piece>& pieces, Coefficients coefficients);
  void require_range(const RealLaw<Real>& terms, const PairLaw& law) const;

  RealRule<Real> rule_;
};

}  // namespace cuboct::gpu
