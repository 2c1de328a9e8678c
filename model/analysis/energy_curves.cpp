// SPDX-License-Identifier: MIT
#include "model/analysis/energy_curves.h"

namespace cuboct {

EnergyCurves::EnergyCurves(bool wanted, const Scene& scene) : scene_(scene), thermometer_(scene) {
  if (!wanted) return;
  for (const char* part : {"kinetic", "potential", "gravity", "total"})
    curves_.push_back({std::string("energy.") + part, "J", {}, {}});
  if (thermometer_.wanted()) curves_.push_back({"temperature", thermometer_.unit(), {}, {}});
  if (volume(0) > 0) curves_.push_back({"pressure", "Pa", {}, {}});
}

void EnergyCurves::add(uint64_t step, const Energies& energies, const Mat3& stress) {
  if (!wanted()) return;
  std::vector<double> values{energies.kinetic, energies.potential, energies.gravity, energies.total()};
  if (thermometer_.wanted()) values.push_back(thermometer_.temperature(energies.free));
  if (volume(step) > 0) values.push_back(pressure(energies, stress, volume(step)));
  for (size_t k = 0; k < values.size(); ++k) {
    curves_[k].step.push_back(step);
    curves_[k].value.push_back(values[k]);
  }
}

}  // namespace cuboct
