// SPDX-License-Identifier: MIT
// Energy of a perfect diamond crystal under Tersoff's potential along a path of strain, with its first and
// second derivative along the path. All are exact, and for any scalar: doubles, or Eigen's dual numbers,
// which carry derivatives by the parameters of the potential.
//
// The atom has its four nearest neighbours alone: R + D is below the distance of the second ones. Both atoms
// of the cell have one energy, as inversion about the bond's middle swaps them, whatever the strain and the
// shift of one against the other.
#pragma once

#include <Eigen/Core>
#include <array>
#include <unsupported/Eigen/AutoDiff>

#include "model/atoms/bond_order/tersoff_terms.h"
#include "model/base/mat3.h"

namespace cuboct {

// Vectors to the four neighbours at t: at + t rate.
struct BondPath {
  std::array<Vec3, 4> at, rate;
};

// A cubic cell of edge `edge` (any unit of length): the deformation gradient is 1 + t gradient, and the
// neighbours, which are the other sublattice, shift by t shift besides.
BondPath diamond_path(double edge, const Mat3& gradient, const Vec3& shift);

template <class P>
struct PathEnergy {
  P energy, slope, curvature;  // of one atom: E, dE/dt, d2E/dt2 at t = 0
};

// A number with its derivative along the path.
template <class P>
using AlongPath = Eigen::AutoDiffScalar<Eigen::Matrix<P, 1, 1>>;

// A function of t as doubles: value, first and second derivative at 0.
struct PathValue {
  double value, slope, curvature;
};
PathValue path_length(const BondPath& path, size_t j);
PathValue path_cosine(const BondPath& path, size_t j, size_t k);

namespace path_detail {

template <class P>
AlongPath<P> dual(const P& value, const P& slope) {
  AlongPath<P> out(value);
  out.derivatives()[0] = slope;
  return out;
}
template <class P>
Sloped<AlongPath<P>> lifted(const PathValue& v) {
  return {dual<P>(P(v.value), P(v.slope)), dual<P>(P(v.slope), P(v.curvature))};
}

template <class P>
TersoffTerm<AlongPath<P>> lifted(const TersoffTerm<P>& t) {
  using S = AlongPath<P>;
  return {t.m,       S(t.gamma),   S(t.lambda3), S(t.c), S(t.d), S(t.cos_theta0), S(t.n),
          S(t.beta), S(t.lambda2), S(t.B),       S(t.R), S(t.D), S(t.lambda1),    S(t.A)};
}

// zeta of bond j and its slope along the path.
template <class S>
Sloped<S> path_zeta(const TersoffTerm<S>& t, const std::array<Sloped<S>, 4>& r,
                    const std::array<std::array<Sloped<S>, 4>, 4>& cosine, size_t j) {
  Sloped<S> zeta{S(0), S(0)};
  for (size_t k = 0; k < 4; ++k) {
    if (k == j) continue;
    const Sloped<S> cut = tersoff_cutoff(t, r[k].value), angle = tersoff_angle(t, cosine[j][k].value);
    const S x = r[j].value - r[k].value, x_slope = r[j].slope - r[k].slope;
    const Sloped<S> stretch = tersoff_stretch(t, x);
    const S held = cut.value * angle.value;
    zeta.value += held * stretch.value;
    zeta.slope += cut.slope * r[k].slope * angle.value * stretch.value;
    zeta.slope += cut.value * angle.slope * cosine[j][k].slope * stretch.value;
    zeta.slope += held * stretch.slope * x_slope;
  }
  return zeta;
}

}  // namespace path_detail

// The chain rule gives dE/dt from the slopes of tersoff_terms.h, and dual numbers differentiate that once
// more.
template <class P>
PathEnergy<P> path_energy(const TersoffTerm<P>& parameters, const BondPath& path) {
  using S = AlongPath<P>;
  const TersoffTerm<S> t = path_detail::lifted(parameters);
  std::array<Sloped<S>, 4> r;
  std::array<std::array<Sloped<S>, 4>, 4> cosine;
  for (size_t j = 0; j < 4; ++j) {
    r[j] = path_detail::lifted<P>(path_length(path, j));
    for (size_t k = 0; k < 4; ++k) cosine[j][k] = path_detail::lifted<P>(path_cosine(path, j, k));
  }
  S energy(0), slope(0);
  for (size_t j = 0; j < 4; ++j) {
    const Sloped<S> zeta = path_detail::path_zeta(t, r, cosine, j), cut = tersoff_cutoff(t, r[j].value);
    const Sloped<S> push = tersoff_repulsion(t, r[j].value), pull = tersoff_attraction(t, r[j].value);
    const Sloped<S> order = tersoff_order(t, zeta.value);
    const S depth = push.value - order.value * pull.value, bend = push.slope - order.value * pull.slope;
    energy += cut.value * depth / S(2);
    slope += (cut.slope * depth + cut.value * bend) * r[j].slope / S(2);
    slope -= cut.value * pull.value * order.slope * zeta.slope / S(2);
  }
  return {energy.value(), slope.value(), slope.derivatives()[0]};
}

}  // namespace cuboct
