// SPDX-License-Identifier: MIT
// The stress-strain curve that a law is to make.
#pragma once

#include <string>
#include <vector>

#include "model/config/config.h"

namespace cuboct::fit {

struct Target {
  std::string source;                  // as the study names it
  std::vector<double> strain, stress;  // -, Pa, as given, from (0, 0) on
  // The same on even strains, straight in between: what curves are compared on.
  std::vector<double> even_strain, even_stress;
  double modulus = 0;       // Pa: slope of the straight line from 0 by least squares, up to 0.5 % of strain
  double strength = 0;      // Pa: the largest stress
  double yield_strain = 0;  // there
};

// [target] of a study: `file`, a CSV file whose path counts from the study's directory, or the lists `strain`
// and `stress`. InputError, with the place, where a unit is missing, a number is none, strains do not ascend,
// or no body at rest can have such a curve.
Target read_target(const ConfigTable& table);

}  // namespace cuboct::fit
