// SPDX-License-Identifier: MIT
// What one bond of the linear peridynamic solid does in a step, for floats and doubles: the one source of the
// reference engine and of the GPU's. docs/reference/peridynamics.md has the formulas.
#pragma once

#include <cmath>

#include "model/base/fixed_math.h"

namespace cuboct {

// A bond now: from the particle to the other, and lengths, all in one unit.
template <class Real>
struct LpsBondNow {
  Real y[3];
  Real length, longer;  // |y|, |y| - |r|
};

// `r`: the bond as packed, `packed` long; `moved`: the displacement of its far end less that of its near one.
// |y| - |r| = moved.(r + y)/(|y| + |r|). The difference of two lengths is off by 1e-7 of a length in floats,
// a thousandth of the stretch at which glass breaks. In doubles it is good, and spares a division.
template <class Real>
CUBOCT_HD inline LpsBondNow<Real> lps_now(const Real* r, Real packed, const Real* moved) {
  using std::sqrt;
  LpsBondNow<Real> now;
  for (int a = 0; a < 3; ++a) now.y[a] = r[a] + moved[a];
  now.length = sqrt(now.y[0] * now.y[0] + now.y[1] * now.y[1] + now.y[2] * now.y[2]);
  if constexpr (sizeof(Real) >= 8) {
    now.longer = now.length - packed;
  } else {
    Real both = 0;
    for (int a = 0; a < 3; ++a) both += moved[a] * (r[a] + now.y[a]);
    now.longer = both / (now.length + packed);
  }
  return now;
}

// What is left of a bond that was stretched by `most` at most, 1 to 0. Beyond 20 widths from the critical
// stretch (1 -+ tanh)/2 is 1 or 0 to the last bit of a double.
template <class Real>
CUBOCT_HD inline Real intact_share(Real most, Real critical, Real width) {
  using std::tanh;
  if (width == 0) return most < critical ? Real(1) : Real(0);
  if (most < critical - 20 * width) return Real(1);
  if (most > critical + 20 * width) return Real(0);
  return (1 - tanh((most - critical) / width)) / 2;
}

// r.moved, which over |r| is the lengthening under small strain.
template <class Real>
CUBOCT_HD inline Real lps_along(const Real* r, const Real* moved) {
  return r[0] * moved[0] + r[1] * moved[1] + r[2] * moved[2];
}

// Of the dilatation round: weight |r| e. `weight`: influence times the far end's volume, of what is left.
template <class Real>
CUBOCT_HD inline Real lps_opening(const LpsBondNow<Real>& now, Real packed, Real weight) {
  return weight * packed * now.longer;
}
template <class Real>
CUBOCT_HD inline Real lps_small_opening(const Real* r, const Real* moved, Real weight) {
  return weight * lps_along(r, moved);
}

// Of the force round: what the bond adds to the force density, over y, or under small strain over r. With
// p = pressure_i + pressure_j and q = (C2 mu/2)(1/m_i + 1/m_j) the density is weight (p |r| + q e) n.
template <class Real>
CUBOCT_HD inline Real lps_pull(const LpsBondNow<Real>& now, Real packed, Real weight, Real p, Real q) {
  return now.length > 0 ? weight * (p * packed + q * now.longer) / now.length : Real(0);
}
template <class Real>
CUBOCT_HD inline Real lps_small_pull(const Real* r, const Real* moved, Real packed, Real weight, Real p,
                                     Real q) {
  return weight * (p + q * lps_along(r, moved) / (packed * packed));
}

// What a particle makes of its openings: theta = (d/m) sum, and C1 (lambda - mu) theta/m. `inverse`: 1/m.
template <class Real>
struct LpsDilated {
  Real dilatation, pressure;
};
template <class Real>
CUBOCT_HD inline LpsDilated<Real> lps_dilated(Real opening, Real inverse, Real dimensions, Real factor) {
  const Real dilatation = opening * (dimensions * inverse);
  return {dilatation, factor * dilatation * inverse};
}

}  // namespace cuboct
