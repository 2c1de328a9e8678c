// SPDX-License-Identifier: MIT
#include "model/contract/hermite.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cuboct {
namespace {

// The slope at an end by the parabola through three points, limited so that the end piece stays monotone (the
// rule of PCHIM): h0, d0 of the end piece, h1, d1 of the next.
double end_slope(double h0, double d0, double h1, double d1) {
  const double m = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (m * d0 <= 0) return 0;
  if (d0 * d1 < 0 && std::abs(m) > 3 * std::abs(d0)) return 3 * d0;
  return m;
}

}  // namespace

std::vector<double> monotone_slopes(const std::vector<double>& r, const std::vector<double>& f) {
  const size_t n = r.size();
  std::vector<double> h(n - 1), d(n - 1), m(n);
  for (size_t k = 0; k + 1 < n; ++k) {
    h[k] = r[k + 1] - r[k];
    d[k] = (f[k + 1] - f[k]) / h[k];
  }
  if (n == 2) return {d[0], d[0]};
  m[0] = end_slope(h[0], d[0], h[1], d[1]);
  m[n - 1] = end_slope(h[n - 2], d[n - 2], h[n - 3], d[n - 3]);
  for (size_t k = 1; k + 1 < n; ++k) {
    // A weighted harmonic mean of the two chords; 0 at an extremum.
    const double w0 = 2 * h[k] + h[k - 1], w1 = h[k] + 2 * h[k - 1];
    m[k] = d[k - 1] * d[k] > 0 ? (w0 + w1) / (w0 / d[k - 1] + w1 / d[k]) : 0;
  }
  return m;
}

size_t piece_of(const std::vector<double>& at, double x) {
  const auto inner = std::upper_bound(at.begin() + 1, at.end() - 1, x);
  return static_cast<size_t>(inner - at.begin()) - 1;
}

Hermite::Hermite(std::vector<double> at, std::vector<double> value, std::vector<double> slope)
    : at_(std::move(at)), value_(std::move(value)), slope_(std::move(slope)), after_(at_.size()) {
  for (size_t k = at_.size() - 1; k-- > 0;) after_[k] = after_[k + 1] + rest_of_piece(k, 0);
}

Hermite::Piece Hermite::piece(size_t k) const {
  const double h = at_[k + 1] - at_[k], rise = value_[k + 1] - value_[k];
  return {h, value_[k], h * slope_[k], 3 * rise - h * (2 * slope_[k] + slope_[k + 1]),
          h * (slope_[k] + slope_[k + 1]) - 2 * rise};
}

double Hermite::integral(const Piece& p, double s) {
  return s * (p.c0 + s * (p.c1 / 2 + s * (p.c2 / 3 + s * (p.c3 / 4))));
}

double Hermite::rest_of_piece(size_t k, double s) const {
  const Piece p = piece(k);
  return p.h * (integral(p, 1) - integral(p, s));
}

double Hermite::at(double x) const {
  const size_t k = piece_of(at_, x);
  const Piece p = piece(k);
  const double s = (x - at_[k]) / p.h;
  return p.c0 + s * (p.c1 + s * (p.c2 + s * p.c3));
}

double Hermite::slope(double x) const {
  const size_t k = piece_of(at_, x);
  const Piece p = piece(k);
  const double s = (x - at_[k]) / p.h;
  return (p.c1 + s * (2 * p.c2 + s * 3 * p.c3)) / p.h;
}

double Hermite::integral_from(double x) const {
  const size_t k = piece_of(at_, x);
  const Piece p = piece(k);
  return after_[k + 1] + rest_of_piece(k, (x - at_[k]) / p.h);
}

std::vector<CubicPiece> Hermite::pieces() const {
  std::vector<CubicPiece> pieces;
  for (size_t k = 0; k + 1 < at_.size(); ++k) {
    const Piece p = piece(k);
    pieces.push_back({at_[k], p.c0, p.c1 / p.h, p.c2 / (p.h * p.h), p.c3 / (p.h * p.h * p.h)});
  }
  return pieces;
}

CubicEnergy Hermite::energies() const {
  CubicEnergy energies;
  for (size_t k = 0; k + 1 < at_.size(); ++k) {
    const Piece p = piece(k);
    const std::array<double, CubicEnergy::terms> terms{at_[k], p.h,      after_[k + 1], integral(p, 1),
                                                       p.c0,   p.c1 / 2, p.c2 / 3,      p.c3 / 4};
    for (size_t of = 0; of < terms.size(); ++of) energies.term[of].push_back(terms[of]);
  }
  return energies;
}

}  // namespace cuboct
