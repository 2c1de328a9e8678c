// SPDX-License-Identifier: MIT
// What a pair of particles does for small displacements: the one place where elasticity and relaxation ask a
// rule.
#pragma once

#include "model/contract/rule.h"

namespace cuboct {

// Derivatives of the pair's energy U at its distance: force constants `axial` e e^T + `lateral` (1 - e e^T).
struct BondConstants {
  double axial = 0;    // U'', N/m
  double lateral = 0;  // U'/r, N/m: above 0 where the pair pulls
};
BondConstants bond_constants(const Rule& rule, int type_i, int type_j, double r);

// No eigenvalue of the body's stiffness (N/m) is above it, where no bond is compressed: 2 times the largest
// of a single particle among fixed neighbours, as (u_i - u_j)^2 <= 2 u_i^2 + 2 u_j^2 for each bond.
double largest_site_stiffness(const Rule& rule, const Body& body, const Periodic& periodic);

}  // namespace cuboct
