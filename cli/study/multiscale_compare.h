// SPDX-License-Identifier: MIT
// What `cuboct multiscale` tells and draws of a study's [compare]: accuracy against cost.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cli/items.h"
#include "model/run/element_run.h"

namespace cuboct {

// Modulus in Pa, Poisson's ratio, speed of the wave in m/s: those that the study has.
using ComparedFigures = std::array<std::optional<double>, 3>;

struct ComparedPoint {
  ElementEffort effort;
  uint64_t atoms = 0, elements = 0;  // of a sample; of the body
  uint64_t atom_steps = 0;           // evaluations of forces times the atoms of a sample, all sets of grains
  double processor = 0;              // s, of all threads
  ComparedFigures figures;           // means over the sets
};
ComparedPoint compared_point(const ElementEffort& effort, const ElementStudy& study,
                             const SampleMaterial& material, const std::vector<SetOutcome>& sets);

struct Comparison {
  std::string title;
  std::vector<ComparedPoint> points;
  ComparedPoint finest;  // what errors are told against
  // A part of the finest point's figure; none where the study has no such figure.
  std::optional<double> error(const ComparedPoint& point, size_t figure) const;
  double largest_error(const ComparedPoint& point) const;
};

Items items_of(const Comparison& compared);
// compare.tsv, a row for each point; compare.svg, by gnuplot.
void write_comparison(const Comparison& compared, const std::string& directory);
void draw_comparison(const Comparison& compared, const std::string& directory);

}  // namespace cuboct
