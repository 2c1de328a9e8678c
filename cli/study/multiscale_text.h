// SPDX-License-Identifier: MIT
// What `cuboct multiscale` tells and draws of a study.
#pragma once

#include <string>
#include <vector>

#include "cli/items.h"
#include "model/run/element_run.h"

namespace cuboct {

struct ElementFindings {
  const ElementStudy& study;
  const SampleMaterial& material;
  std::vector<SetOutcome> sets;
};

// A mean over sets: its standard error, and the sets' own spread.
struct SetMean {
  double mean = 0, error = 0, deviation = 0;
};
SetMean mean_of(const std::vector<double>& values);

Items items_of(const ElementFindings& found);

// Tables for other programs: stretch.tsv, front.tsv. Pictures by gnuplot: stress, volume (svg), front (svg),
// velocity (png) of the first set.
void write_element_tables(const ElementFindings& found, const std::string& directory);
void draw_elements(const ElementFindings& found, const std::string& directory);

}  // namespace cuboct
