// SPDX-License-Identifier: MIT
// What a rule's text begins with, in doubles.
#pragma once

#include <vector>

#include "model/rules/reference_bonds.h"

namespace cuboct {

// By number of the rule's fields, then by particle, or by bond of `rows`: of the body as packed, or what
// Body::bonds kept.
struct ProgramStart {
  std::vector<std::vector<double>> particle;
  ReferenceBonds rows{{0}, {}, {}};  // none of a rule whose bonds are those of the moment
  std::vector<std::vector<double>> bond;
};

}  // namespace cuboct
