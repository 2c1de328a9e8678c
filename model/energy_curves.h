// SPDX-License-Identifier: MIT
// The energies of a run over its steps, and the pressure of a box that repeats along all axes.
#pragma once

#include <functional>
#include <vector>

#include "model/measure.h"

namespace cuboct {

class EnergyCurves {
 public:
  // `volume`: m^3, of a box that repeats along all axes; else 0. Not `wanted`: no curves.
  EnergyCurves(bool wanted, double volume);
  bool wanted() const { return !curves_.empty(); }
  double volume() const { return volume_; }
  // `stress`, Pa, is asked for the pressure alone.
  void add(uint64_t step, const Energies& energies, const std::function<Mat3()>& stress);
  // energy.kinetic, energy.potential, energy.gravity, energy.total in J; then pressure in Pa.
  const std::vector<Curve>& curves() const { return curves_; }
  // Curves that an earlier run of the same kind has given.
  void restore(std::vector<Curve> curves) { curves_ = std::move(curves); }

 private:
  double volume_;
  std::vector<Curve> curves_;
};

}  // namespace cuboct
