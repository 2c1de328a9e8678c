// SPDX-License-Identifier: MIT
// Phase two of the learning and what follows from it: the critical stretch from a sheet of atoms that cracks,
// and predictions beside atoms.
#pragma once

#include "study/learn/learn.h"
#include "study/learn/stretch_fit.h"

namespace cuboct::learn {

struct CrackModel {
  Kernel kernel;
  double validation = 0;             // residual of the kernel's own fit
  StretchFit stretch;                // of the training's grid
  std::array<CrackErrors, 3> tests;  // of kCrackTests
};

// Sections 5.2 to 5.4, by number, with the load (FractureLoad) and the grid of each.
inline constexpr std::array<const char*, 3> kCrackTests{"longer time", "other load", "finer grid"};
constexpr size_t load_of_test(size_t test) { return test == 1 ? 1 : 0; }
constexpr size_t grid_of_test(size_t test) { return test == 2 ? 1 : 0; }
// What the paper reports: displacement, damage.
struct PaperErrors {
  double displacement, damage;
};
inline constexpr PaperErrors kPaperErrors[] = {{0.27, 0.09}, {0.58, 0.15}, {0.19, 0.30}};

// Accuracy and cost of a model, of one load.
struct CostPoint {
  std::string model;
  int points = 0;  // along an edge; 0: atoms
  FractureLoad load = FractureLoad::pulled;
  CrackErrors errors;
  double seconds = 0;  // of a core
};

struct Cracks {
  std::vector<Grid> grids;
  std::array<FractureSample, 2> samples;  // FractureLoad
  CrackModel model;
  std::vector<CrackModel> drawn;  // of samples drawn anew
  CrackModel pairs;               // a pair law of one power of distance, of the same data
  std::vector<CostPoint> cost;
  std::array<std::vector<CrackState>, 3> seen, predicted;  // [test][frame], of `model`
};

// Before the work. InputError where the slit parts the sheet, or the horizon has too few points on a grid.
void check_cracks(const LearnStudy& study);
// DIR/cracks.jsonl keeps what the atoms did. Throws study::Interrupted.
Cracks learn_cracks(const LearnStudy& study, const Learned& learned, const std::string& directory, int jobs);

}  // namespace cuboct::learn
