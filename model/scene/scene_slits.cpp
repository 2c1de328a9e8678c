// SPDX-License-Identifier: MIT
// [[rule.slit]]: cuts that are there from the start.
#include "model/scene/scene_parts.h"

namespace cuboct {

std::vector<Slit> read_slits(const ConfigTable& table) {
  std::vector<Slit> slits;
  for (const ConfigTable& one : table.tables("slit")) {
    one.record_as("rule");
    Slit slit{one.at("corner").vector(quantity::length), one.at("along").vector(quantity::length),
              one.at("across").vector(quantity::length)};
    if (slit.along.cross(slit.across).norm() <= 1e-9 * slit.along.norm() * slit.across.norm())
      one.fail("'along' and 'across' of a slit span no plane");
    one.done();
    slits.push_back(slit);
  }
  return slits;
}

}  // namespace cuboct
