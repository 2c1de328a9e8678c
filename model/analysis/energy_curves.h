// SPDX-License-Identifier: MIT
// The energies of a run over its steps, its temperature, and the pressure of a box that repeats along all
// axes.
#pragma once

#include <vector>

#include "model/analysis/measure.h"
#include "model/analysis/temperature.h"
#include "model/base/mat3.h"

namespace cuboct {

class EnergyCurves {
 public:
  // Not `wanted`: no curves. Keeps a reference to `scene`.
  EnergyCurves(bool wanted, const Scene& scene);
  bool wanted() const { return !curves_.empty(); }
  // m^3, of a box that repeats along all axes; else 0.
  double volume(uint64_t step) const { return scene_.box_at(step).extent.prod(); }
  // `stress`, Pa: for the pressure alone.
  void add(uint64_t step, const Energies& energies, const Mat3& stress);
  // energy.kinetic, energy.potential, energy.gravity, energy.total in J; then, where the scene has them,
  // temperature in K (reduced units: J) and pressure in Pa.
  const std::vector<Curve>& curves() const { return curves_; }
  // Curves that an earlier run of the same kind has given.
  void restore(std::vector<Curve> curves) { curves_ = std::move(curves); }

 private:
  const Scene& scene_;
  Thermometer thermometer_;
  std::vector<Curve> curves_;
};

}  // namespace cuboct
