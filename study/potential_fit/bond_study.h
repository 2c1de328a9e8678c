// SPDX-License-Identifier: MIT
// The study file of a fit of Tersoff's parameters. docs/user/potential-fit.md is the reference of the format.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "study/potential_fit/endurance.h"
#include "study/potential_fit/loss.h"

namespace cuboct::bond_fit {

// A published set of parameters.
struct NamedSet {
  std::string name;
  TersoffTerm<double> term;
};

struct Compare {
  int starts = 0, evaluations = 0;
};

struct BondStudy {
  std::string path, title, element;
  Problem problem;
  uint64_t seed = 1;             // of the random starts
  int starts = 0;                // random ones
  int evaluations = 0;           // of the loss, of one start
  std::optional<NamedSet> from;  // the first start
  std::vector<NamedSet> beside;  // shown beside the fit
  double enough = 0;             // losses below are equal
  size_t tried = 0;              // sets by molecular dynamics
  Trial trial;
  std::optional<Compare> compare;  // descents of several methods from the same starts
  uint64_t hash = 0;               // of all that starts and trials depend on
};

// Throws InputError with file:line:column.
BondStudy read_bond_study(const std::string& path);

// The properties as the file names them, in the order of DiamondProperty.
const std::array<std::string, kDiamondProperties>& property_names();

}  // namespace cuboct::bond_fit
