// SPDX-License-Identifier: MIT
// A function of one number by its values at equal steps from 0 on.
//
// Between two values it is the cubic with their slopes, which five values give each (four next to an end, two
// at the end): PairEAM::interpolate of LAMMPS's pair_eam.cpp, so that energies of a file are LAMMPS's to the
// last digits. Beyond the last value it is worth what it is there; below 0 the first cubic goes on.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "model/program/table_curve.h"

namespace cuboct {

class CubicTable final : public TableCurve {
 public:
  static constexpr size_t kLeastValues = 5;

  // `what`: of which function, for people. `bounded`: an argument beyond the end is an error of who asks.
  CubicTable(std::string what, double step, const std::vector<double>& values, bool bounded);

  double at(double x) const override {
    const auto [c, p] = place(x);
    return ((c[3] * p + c[2]) * p + c[1]) * p + c[0];
  }
  double slope(double x) const override {
    const auto [c, p] = place(x);
    return ((3 * c[3] * p + 2 * c[2]) * p + c[1]) * per_step_;
  }
  double end() const override { return step_ * static_cast<double>(bins()); }
  double step() const { return step_; }
  size_t bins() const { return cubics_.size() / 4; }
  // Between values `bin` and `bin + 1`: of powers 0 to 3 of the steps from the first of both.
  const double* cubic(size_t bin) const { return cubics_.data() + 4 * bin; }
  const std::string& what() const override { return what_; }
  bool bounded() const override { return bounded_; }
  std::pair<double, double> range(bool of_slope) const override;

 private:
  struct Place {
    const double* c;  // of its cubic
    double p;         // steps from its begin
  };
  Place place(double x) const {
    const double steps = x * per_step_;
    // Not a number: the last.
    const size_t bin =
        steps < static_cast<double>(bins() - 1) ? static_cast<size_t>(std::max(steps, 0.0)) : bins() - 1;
    return {cubics_.data() + 4 * bin, std::min(steps - static_cast<double>(bin), 1.0)};
  }

  std::string what_;
  double step_, per_step_;
  bool bounded_;
  std::vector<double> cubics_;  // [bin][power]
};

}  // namespace cuboct
