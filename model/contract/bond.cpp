// SPDX-License-Identifier: MIT
#include "model/contract/bond.h"

#include <cmath>

#include "model/base/dense.h"
#include "model/contract/neighbours.h"

namespace cuboct {

BondConstants bond_constants(const Rule& rule, int type_i, int type_j, double r) {
  if (r >= rule.reach(type_i, type_j)) return {};
  const double strength = rule.strength_of(type_i, type_j);
  const PairLaw& law = rule.law_of(type_i, type_j);
  return {-strength * law.slope(r), -strength * law.force(r) / r};
}

double largest_site_stiffness(const Rule& rule, const Body& body, const Periodic& periodic) {
  std::vector<Mat3> site(body.size(), Mat3::Zero());
  CellList cells(rule.cutoff(), periodic);
  cells.build(body.x);
  cells.for_each_pair(body.x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    const BondConstants bond = bond_constants(rule, body.type[i], body.type[j], r);
    const Mat3 along = d * d.transpose() / (r * r);
    const Mat3 block = std::abs(bond.lateral) * (Mat3::Identity() - along) + std::abs(bond.axial) * along;
    site[i] += block, site[j] += block;
  });
  double most = 0;
  for (size_t i = 0; i < body.size(); ++i) {
    const ParticleType& type = rule.types[body.type[i]];
    const Mat3 own = 2 * site[i] + (type.pd ? type.kp : 0.0) * Mat3::Identity();
    most = std::max(most, eigenvalues(own)[2]);
  }
  return most;
}

}  // namespace cuboct
