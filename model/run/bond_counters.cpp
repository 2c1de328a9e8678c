// SPDX-License-Identifier: MIT
#include "model/run/bond_counters.h"

#include <algorithm>

namespace cuboct {

Counters bond_counters(const Rule& rule, const RoundsTerms& terms, size_t particles) {
  Counters counters{{"bonds", static_cast<double>(terms.bonds())}};
  // Bonds of the moment are whole or are not there.
  if (!has_reference_bonds(rule)) return counters;
  double damaged = 0, most = 0;
  for (const double damage : terms.damage()) damaged += damage, most = std::max(most, damage);
  counters.emplace_back("mean_damage", damaged / static_cast<double>(particles));
  counters.emplace_back("largest_damage", most);
  return counters;
}

}  // namespace cuboct
