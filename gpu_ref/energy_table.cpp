// SPDX-License-Identifier: MIT
#include "gpu_ref/energy_table.h"

#include <cmath>

#include "model/contract/rule.h"

namespace cuboct::gpu {

EnergyTables::EnergyTables(const Rule& rule) {
  const PairLaw& law = *rule.law;
  const double cutoff = law.cutoff(), core = law.core() / cutoff;
  // dU/ds = -f dr/ds, dr/ds = cutoff^2/(2 r). Just below the cutoff, where the force may jump.
  const auto slope = [&](double r) { return -law.force(r) * cutoff * cutoff / (2 * r); };
  rule_.core2 = core * core;
  rule_.core_energy = law.energy(law.core());
  rule_.core_slope = slope(law.core());
  rule_.first_bin = bin_bits(rule_.core2, kEnergyShift);
  node = {rule_.core_energy, rule_.core_slope};
  const int end = bin_bits(1.0, kEnergyShift);
  for (int bits = rule_.first_bin + 1; bits <= end; ++bits) {
    const double s =
        std::bit_cast<double>(static_cast<uint64_t>(static_cast<uint32_t>(bits)) << (32 + kEnergyShift));
    const double r = bits < end ? std::sqrt(s) * cutoff : std::nextafter(cutoff, 0.0);
    node.push_back(law.energy(r));
    node.push_back(slope(r));
  }
  if (!rule.contact.empty()) {
    rule_.contact2 = std::pow(rule.contact_distance / cutoff, 2);
    rule_.contact_energy = law.energy(rule.contact_distance);
  }
  rule_.type_count = static_cast<int>(rule.types.size());
  for (int i = 0; i < rule_.type_count; ++i) {
    for (int j = 0; j < rule_.type_count; ++j)
      strength.push_back(rule.only_touch(i, j) ? -rule.strength_of(i, j) : rule.strength_of(i, j));
    mass.push_back(rule.relative_mass(i));
    for (int axis = 0; axis < 3; ++axis) {
      weight.push_back(rule.mass_of(i) * rule.types[i].gravity[axis] * cutoff);
      free.push_back(is_free(rule.types[i], axis) ? 1 : 0);
    }
  }
  const double velocity = cutoff / rule.dt;
  rule_.kinetic = rule.mass * velocity * velocity / 2;
}

}  // namespace cuboct::gpu
