// SPDX-License-Identifier: MIT
// The functions that Tersoff's potential is made of, for any scalar: doubles, or numbers that carry
// derivatives. J. Tersoff, Phys. Rev. B 37 (1988) 6991; the general form with gamma, lambda3 and m is
// LAMMPS's `pair_style tersoff`. Energies have the unit of A and B, lengths that of R and D.
//
//   E = sum_i E_i,  E_i = 1/2 sum_j fc(r_ij) (A exp(-lambda1 r_ij) - b_ij B exp(-lambda2 r_ij))
//   b_ij = (1 + (beta zeta_ij)^n)^(-1/2n)
//   zeta_ij = sum_{k != i,j} fc(r_ik) g(cos theta_ijk) exp((lambda3 (r_ij - r_ik))^m)
#pragma once

#include <cmath>
#include <numbers>

#include "model/base/fixed_math.h"

namespace cuboct {

// Of one ordered triple of elements (i, j, k): zeta takes gamma ... cos_theta0, R and D of the triple; the
// bond takes n ... A, R and D of (i, j, j).
template <class Real>
struct TersoffTerm {
  int m = 3;                                  // 1 or 3
  Real gamma = 1, lambda3 = 0, c = 0, d = 1;  // lambda3: 1/length
  Real cos_theta0 = 0, n = 1, beta = 0;       // no unit
  Real lambda2 = 0, B = 0, R = 0, D = 0;      // 1/length, energy, length, length
  Real lambda1 = 0, A = 0;                    // 1/length, energy
};

// A function's value and its derivative by the argument.
template <class Real>
struct Sloped {
  Real value, slope;
};

// fc falls from 1 at R - D to 0 at R + D.
template <class Real>
CUBOCT_HD Sloped<Real> tersoff_cutoff(const TersoffTerm<Real>& t, const Real& r) {
  using std::cos, std::sin;
  if (r < t.R - t.D) return {Real(1), Real(0)};
  if (!(r < t.R + t.D)) return {Real(0), Real(0)};
  const Real turn = Real(std::numbers::pi / 2) / t.D, angle = turn * (r - t.R);
  return {(Real(1) - sin(angle)) / Real(2), -turn * cos(angle) / Real(2)};
}

// g and dg/dcos. The usual gamma (1 + c^2/d^2 - c^2/(d^2 + u^2)), u = cos - cos_theta0, without its
// cancellation.
template <class Real>
CUBOCT_HD Sloped<Real> tersoff_angle(const TersoffTerm<Real>& t, const Real& cosine) {
  const Real u = cosine - t.cos_theta0, d2 = t.d * t.d, over = Real(1) / (d2 + u * u);
  const Real c2 = t.gamma * t.c * t.c;
  return {t.gamma + c2 * u * u * over / d2, Real(2) * c2 * u * over * over};
}

// exp((lambda3 x)^m) and its slope by x = r_ij - r_ik. Beyond an exponent of 69 the value is 1e30 with no
// slope, as in LAMMPS: such a bond has no order left.
template <class Real>
CUBOCT_HD Sloped<Real> tersoff_stretch(const TersoffTerm<Real>& t, const Real& x) {
  using std::exp;
  const Real y = t.lambda3 * x;
  const Real power = t.m == 3 ? y * y * y : y;
  if (power > Real(69.0776)) return {Real(1e30), Real(0)};
  if (power < Real(-69.0776)) return {Real(0), Real(0)};
  const Real value = exp(power);
  return {value, value * (t.m == 3 ? Real(3) * t.lambda3 * y * y : t.lambda3)};
}

// b and db/dzeta, zeta >= 0. With u = n log(beta zeta) and e = exp(-|u|) nothing overflows:
//   log(1 + exp(u)) = max(u, 0) + log(1 + e),  zeta db/dzeta = -b/2 exp(u)/(1 + exp(u)).
template <class Real>
CUBOCT_HD Sloped<Real> tersoff_order(const TersoffTerm<Real>& t, const Real& zeta) {
  using std::exp, std::log;
  const Real x = t.beta * zeta;
  if (!(x > Real(1e-300))) return {Real(1), Real(0)};
  const Real u = t.n * log(x);
  const bool large = u > Real(0);
  const Real e = exp(large ? Real(-u) : u);
  const Real b = exp(-((large ? u : Real(0)) + log(Real(1) + e)) / (Real(2) * t.n));
  return {b, -b * (large ? Real(1) : e) / (Real(1) + e) / (Real(2) * zeta)};
}

// A exp(-lambda1 r) and B exp(-lambda2 r).
template <class Real>
CUBOCT_HD Sloped<Real> tersoff_repulsion(const TersoffTerm<Real>& t, const Real& r) {
  using std::exp;
  const Real value = t.A * exp(-t.lambda1 * r);
  return {value, -t.lambda1 * value};
}
template <class Real>
CUBOCT_HD Sloped<Real> tersoff_attraction(const TersoffTerm<Real>& t, const Real& r) {
  using std::exp;
  const Real value = t.B * exp(-t.lambda2 * r);
  return {value, -t.lambda2 * value};
}

}  // namespace cuboct
