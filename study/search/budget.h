// SPDX-License-Identifier: MIT
// The cheapest settings of a study that keep a figure within an error budget: search.h on real runs.
#pragma once

#include <string>
#include <vector>

#include "study/search/search.h"
#include "study/sweep/store.h"
#include "study/sweep/study.h"
#include "study/sweep/truth.h"

namespace cuboct::study {

struct BudgetQuestion {
  size_t figure = 0;     // of study.figures
  double budget = 0.01;  // > 0, relative
  int jobs = 0;          // runs at once; 0: one per core
  bool progress = true;  // a line on stderr, where that is a terminal
};

struct Priced {
  Settings settings;
  double value = kNotMeasured;  // of the figure, in its unit
  double error = kNotMeasured;  // (value - truth)/|truth|
  double dt = 0;                // s, as the study's time grid leaves it
  double cost = kNotMeasured;   // cost.h, at that time step; nan: no plan
  std::string why;              // where something is not measured
};

struct BudgetAnswer {
  std::vector<Axis> axes;  // as searched: study.search in the order of search.h
  SearchResult result;     // its notches are places on these axes
  // Of each of result.cheaper that cannot be run: why not; else empty.
  std::vector<std::string> why;
  Priced chosen;    // result.best
  Priced standard;  // the study's scene and arch as they are
};

// Runs what it needs, several at once, and puts each into `store`, out of which a search that was killed goes
// on. Each run measures figures alone, so `store` must not be that of a study's points. `truth` is the
// study's: also where settings change the packing, as the figure is to be that of the material and not of its
// packing. Throws InputError: a truth that is worse than the budget or has no such figure, notches that do
// not go from cheap to dear; Interrupted (interrupted.h).
BudgetAnswer keep_budget(const Study& study, const Truth& truth, Store& store,
                         const BudgetQuestion& question);

// Figures and nothing else of one run; never throws but Interrupted.
Outcome measure_figures(const Study& study, const Truth& truth, const Settings& settings);

// Settings as an input of `cuboct run`: the study's scene and arch with their comments, with the time step,
// the steps and the probes' readings of the study's time grid.
struct Written {
  std::string scene, arch;
};
Written written(const Study& study, const Truth& truth, const Settings& settings);

// Settings of a point, as the engines look at them.
Settings settings_at(const std::vector<Axis>& axes, const Notches& at);
// Whether another notch of an axis makes other settings there: engines of real numbers look at no arch.
bool matters(const std::vector<Axis>& axes, Notches at, size_t axis);

}  // namespace cuboct::study
