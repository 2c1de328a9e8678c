// SPDX-License-Identifier: MIT
// What a fit has computed so far, in a file that survives the process: the search is computed anew from it,
// which gives the same samples, and none is simulated twice.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "study/law_fit/fit_study.h"
#include "study/sweep/kept_lines.h"

namespace cuboct::fit {

struct Evaluation {
  std::vector<double> sample;  // of the search
  double error = 0;            // curve_error; kRefused where there was no run
  std::vector<double> stress;  // Pa, on the target's even strains
  double largest_strain = 0;   // that was read
  uint64_t particle_steps = 0;
  double seconds = 0;  // of one core
  std::string stop;    // of a run that ended early
};

// As far from the target as none that runs.
inline constexpr double kRefused = 10;

class Evaluations {
 public:
  // DIR/evaluations.jsonl. Throws InputError where it is another study's, or no such file.
  Evaluations(const std::string& directory, const FitStudy& study);

  // By their samples; null: not there.
  const Evaluation* find(const std::vector<double>& sample) const;
  const Evaluation& add(Evaluation evaluation);
  // Writes what was added: all of the file, or none.
  void save() { kept_.save(); }

  size_t size() const { return kept_.size(); }

 private:
  std::map<std::vector<double>, Evaluation> known_;
  study::KeptLines kept_;
};

}  // namespace cuboct::fit
