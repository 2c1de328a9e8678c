// SPDX-License-Identifier: MIT
// The search for a law whose virtual test makes the target's curve.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "study/law_fit/evaluations.h"
#include "study/law_fit/identifiability.h"

namespace cuboct::fit {

enum class End : uint8_t { converged, goal, generations };

struct Fit {
  const Evaluation* cheap = nullptr;    // the law of modulus, strength and yield strain
  const Evaluation* packing = nullptr;  // that of the evenly deformed packing (packing_fit.h)
  const Evaluation* best = nullptr;     // so far
  std::vector<double> errors;  // of all samples of the search, in their order; the start is not among them
  std::vector<double> best_errors;    // after each generation
  std::vector<double> least_medians;  // of the errors of a generation's samples, so far in its round
  End end = End::generations;
  size_t evaluations = 0;
  uint64_t particle_steps = 0;
  double seconds = 0;              // of one core, all runs together, those of earlier commands too
  std::vector<std::string> notes;  // what is to be known of target and scene
  // At the best law, of the parameters whose bounds leave them free; by moves of a fiftieth of the bounds.
  std::vector<size_t> free;
  double told_within = 0;  // curves that differ by less, over the target, are equal
  Identifiability told;
};

struct FitOptions {
  int jobs = 0;  // runs at once; 0: one per core
  bool progress = true;
  // After each generation, with what is known so far.
  std::function<void(const Fit&)> see = [](const Fit&) {};
};

// Answers from `evaluations` where it can and saves there: after an end by study::Interrupted, or a kill, the
// same call ends with the same law to the last bit.
Fit run_fit(const FitStudy& study, Evaluations& evaluations, const FitOptions& options);

// The scene with the law of some sample: what every engine runs.
std::string fitted_scene(const FitStudy& study, const Evaluation& evaluation);

}  // namespace cuboct::fit
