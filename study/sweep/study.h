// SPDX-License-Identifier: MIT
// A study file: one scene, the axes that are swept, the figures that count. docs/user/study.md is the
// reference of the format.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/trace/figure.h"
#include "study/sweep/outcome.h"
#include "study/sweep/time_grid.h"

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
  Base base;  // with the study's [change] made
  std::vector<Figure> figures;
  std::vector<std::string> figure_units;
  std::vector<Settings> points;   // of all [[sweep]] grids, in their order, each once
  std::vector<Axis> search;       // [search]: for each setting its notches from cheap to dear
  TimeGrid grid;                  // of all runs; horizon 0 until the truth has found it
  double horizon = 0;             // s, where trajectories are compared at the latest; 0: the truth decides
  int repeats = 3;                // of each speed
  double seconds = 0.3;           // of host time that each repeat takes at least
  double truth_tolerance = 1e-4;  // refinement of the truth ends where every figure changes by less
  int truth_rungs = 8;            // and after so many time steps
  bool lengthen_cutoff = true;    // of a law that is cut off for speed alone (lj)
  uint64_t hash = 0;  // of all that errors depend on but the points: results of another are refused
};

// Throws InputError with file:line:column.
Study read_study(const std::string& path);

// Particle-steps of a run: for the order and the time left, so a guess will do. Doubles take about as long as
// ten fixed ones. 0: the settings make no scene.
double size_of_run(const Study& study, const Settings& settings);

// Settings with what their engine does not look at taken out, so that equal runs have equal settings: an
// engine of real numbers knows no arch, a GPU none of the host's threads.
Settings canonical(Settings settings);

}  // namespace cuboct::study
