// SPDX-License-Identifier: MIT
// A study file: one scene, the axes that are swept, the figures that count. docs/user/study.md is the
// reference of the format.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/figure.h"
#include "study/outcome.h"

namespace cuboct::study {

// A named list of settings: "dt_safety" with 0.05, 0.1, ... An axis may set several keys at once (presets of
// widths).
struct Axis {
  std::string name;                                  // of the key in the file
  std::vector<std::string> labels;                   // one per notch, for people: "0.05", "P20 D16"
  std::vector<std::function<void(Settings&)>> sets;  // one per notch
};

struct Study {
  std::string path;
  std::string title;
  Base base;
  std::vector<Figure> figures;
  std::vector<Settings> points;   // of all [[sweep]] grids, in their order, each once
  std::vector<Axis> search;       // [search]: for each setting its notches from cheap to dear
  int repeats = 3;                // of each speed
  double seconds = 0.3;           // of host time that each repeat takes at least
  double truth_tolerance = 1e-4;  // refinement of the truth ends where every figure changes by less
  uint64_t hash = 0;              // of the study, scene and arch texts: results of another study are refused
};

// Throws InputError with file:line:column.
Study read_study(const std::string& path);

}  // namespace cuboct::study
