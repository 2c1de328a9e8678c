// SPDX-License-Identifier: MIT
// A function of one number by its values at rising places: between two of them the cubic with their slopes.
// The first and the last cubic take what lies outside.
#pragma once

#include <vector>

#include "model/contract/law_energies.h"
#include "model/contract/law_form.h"

namespace cuboct {

class Hermite {
 public:
  // At least two places, and as many values and slopes.
  Hermite(std::vector<double> at, std::vector<double> value, std::vector<double> slope);

  double at(double x) const;
  double slope(double x) const;
  double integral_from(double x) const;  // to the last place
  double begin() const { return at_.front(); }
  double end() const { return at_.back(); }
  double first() const { return value_.front(); }
  double last() const { return value_.back(); }

  // The same as a force over distances.
  std::vector<CubicPiece> pieces() const;
  CubicEnergy energies() const;

 private:
  // On piece k with s = (x - at[k])/h:  f = c0 + s (c1 + s (c2 + s c3)).
  struct Piece {
    double h, c0, c1, c2, c3;
  };
  Piece piece(size_t k) const;
  // Of the piece up to s, in widths.
  static double integral(const Piece& p, double s);
  double rest_of_piece(size_t k, double s) const;

  std::vector<double> at_, value_, slope_;
  std::vector<double> after_;  // [place]: the integral from it to the last
};

// Index k of the piece [at[k], at[k+1]) that holds x; the end pieces take what lies outside.
size_t piece_of(const std::vector<double>& at, double x);

// Slopes that keep each stretch between two values monotone, and an extremum one of them: Fritsch and Butland
// (law.h).
std::vector<double> monotone_slopes(const std::vector<double>& at, const std::vector<double>& value);

}  // namespace cuboct
