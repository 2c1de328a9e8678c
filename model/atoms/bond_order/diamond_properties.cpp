// SPDX-License-Identifier: MIT
#include "model/atoms/bond_order/diamond_properties.h"

#include "model/atoms/bond_order/diamond_strain.h"

namespace cuboct {
namespace {

// Of a term, in the order of kTersoffFreeNames.
template <class Real>
std::array<Real*, kTersoffFree> places_of(TersoffTerm<Real>& t) {
  return {&t.A, &t.B, &t.lambda1, &t.lambda2, &t.lambda3, &t.beta, &t.n, &t.gamma, &t.c, &t.d, &t.cos_theta0};
}

// A number with its derivatives by the parameters.
using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, int{kTersoffFree}, 1>>;

TersoffTerm<Dual> dual_term(TersoffTerm<double> t) {
  TersoffTerm<Dual> out;
  out.m = t.m;
  out.R = Dual(t.R), out.D = Dual(t.D);
  const auto from = places_of(t);
  const auto to = places_of(out);
  for (size_t k = 0; k < kTersoffFree; ++k) *to[k] = Dual(*from[k], int{kTersoffFree}, static_cast<int>(k));
  return out;
}

template <class P>
struct Values {
  std::array<P, kDiamondProperties> of;
  P inner;
};

// Five paths tell all: the cell swells, is drawn along x and pressed along y, is sheared, has its sublattices
// shifted, and both of these at once, which holds the mixed derivative. Per strain^2: the first has 9 bulk
// (with E'' - 2 E' = 9 V^2 d2E/dV2), the second 4 C'. At rest C11 = bulk + 4/3 C', C12 = bulk - 2/3 C'. The
// sublattices shift to where the energy is least: C44 loses (mixed)^2/inner.
template <class P>
Values<P> values_of(const TersoffTerm<P>& t, double edge) {
  Mat3 drawn = Mat3::Zero(), sheared = Mat3::Zero();
  drawn(0, 0) = 1, drawn(1, 1) = -1, sheared(0, 1) = 1;
  const Mat3 none = Mat3::Zero(), swell = Mat3::Identity();
  const Vec3 still = Vec3::Zero(), shift(0, 0, edge);
  const double volume = edge * edge * edge / 8;
  const auto at = [&](const Mat3& gradient, const Vec3& by) {
    return path_energy(t, diamond_path(edge, gradient, by));
  };
  const PathEnergy<P> swelling = at(swell, still);
  const P shear = at(sheared, still).curvature, inner = at(none, shift).curvature;
  const P both = at(sheared, shift).curvature, mixed = (both - shear - inner) / P(2);
  Values<P> out;
  out.of[cohesive] = swelling.energy;
  out.of[edge_slope] = swelling.slope / P(edge);
  out.of[bulk] = (swelling.curvature - P(2) * swelling.slope) / P(9 * volume);
  out.of[c_prime] = at(drawn, still).curvature / P(4 * volume);
  out.of[c11] = out.of[bulk] + out.of[c_prime] * P(4.0 / 3);
  out.of[c12] = out.of[bulk] - out.of[c_prime] * P(2.0 / 3);
  out.of[c44_clamped] = shear / P(volume);
  out.of[c44] = (shear - mixed * mixed / inner) / P(volume);
  out.inner = inner / P(edge * edge);
  return out;
}

}  // namespace

TersoffFree free_of(const TersoffTerm<double>& term) {
  TersoffTerm<double> copy = term;
  TersoffFree out;
  const auto places = places_of(copy);
  for (size_t k = 0; k < kTersoffFree; ++k) out[k] = *places[k];
  return out;
}

TersoffTerm<double> with_free(TersoffTerm<double> term, const TersoffFree& values) {
  const auto places = places_of(term);
  for (size_t k = 0; k < kTersoffFree; ++k) *places[k] = values[k];
  return term;
}

DiamondProperties diamond_properties(const TersoffTerm<double>& term, double edge, bool slopes) {
  DiamondProperties out;
  if (!slopes) {
    const Values<double> values = values_of(term, edge);
    out.value = values.of, out.inner = values.inner;
    return out;
  }
  const Values<Dual> values = values_of(dual_term(term), edge);
  for (size_t p = 0; p < kDiamondProperties; ++p) {
    out.value[p] = values.of[p].value();
    for (size_t k = 0; k < kTersoffFree; ++k)
      out.slopes[p][k] = values.of[p].derivatives()[static_cast<int>(k)];
  }
  out.inner = values.inner.value();
  return out;
}

}  // namespace cuboct
