// SPDX-License-Identifier: MIT
#include "emu/gpu/real/energy_table.h"

#include <cmath>

#include "model/contract/rule.h"

namespace cuboct::gpu {

// `cutoff`: of the rule, m.
EnergyLaw EnergyTables::take_law(const PairLaw& law, double cutoff) {
  EnergyLaw terms;
  const double core = law.core() / cutoff, end = law.cutoff() / cutoff;
  // dU/ds = -f dr/ds, dr/ds = cutoff^2/(2 r). Just below the cutoff, where the force may jump.
  const auto slope = [&](double r) { return -law.force(r) * cutoff * cutoff / (2 * r); };
  terms.first = static_cast<int>(node.size());
  terms.core2 = core * core;
  terms.cutoff2 = end * end;
  terms.core_energy = law.energy(law.core());
  terms.core_slope = slope(law.core());
  terms.first_bin = bin_bits(terms.core2, kEnergyShift);
  node.insert(node.end(), {terms.core_energy, terms.core_slope});
  for (int bits = terms.first_bin + 1;; ++bits) {
    const double s =
        std::bit_cast<double>(static_cast<uint64_t>(static_cast<uint32_t>(bits)) << (32 + kEnergyShift));
    const double r = s < terms.cutoff2 ? std::sqrt(s) * cutoff : std::nextafter(law.cutoff(), 0.0);
    node.insert(node.end(), {law.energy(r), slope(r)});
    if (!(s < terms.cutoff2)) return terms;
  }
}

EnergyTables::EnergyTables(const Rule& rule) {
  const double cutoff = rule.cutoff();
  for (size_t k = 0; k < rule.laws(); ++k) {
    rule_.law[k] = take_law(rule.law_at(k), cutoff);
    if (!rule.contact.empty()) rule_.law[k].contact_energy = rule.law_at(k).energy(rule.contact_distance);
  }
  rule_.several = rule.laws() > 1;
  if (!rule.contact.empty()) rule_.contact2 = std::pow(rule.contact_distance / cutoff, 2);
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
  for (int i = 0; rule_.several && i < rule_.type_count; ++i)
    for (int j = 0; j < rule_.type_count; ++j)
      strength.push_back(static_cast<double>(rule.law_index_of(i, j)));
  const double velocity = cutoff / rule.dt;
  rule_.kinetic = rule.mass * velocity * velocity / 2;
}

}  // namespace cuboct::gpu
