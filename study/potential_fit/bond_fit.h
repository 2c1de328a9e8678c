// SPDX-License-Identifier: MIT
// The fit of Tersoff's parameters to a crystal: many starts downhill, the best of them tried by molecular
// dynamics.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/potential_fit/bond_study.h"
#include "study/potential_fit/search.h"

namespace cuboct::bond_fit {

struct Tried {
  size_t start = 0;   // of BondFit::starts
  std::string fault;  // of the lattice itself; empty: it has an edge without pressure
  double edge = 0;    // angstrom, that edge
  Endurance endurance;
  bool stable() const { return fault.empty() && endurance.stable(); }
};

struct BondFit {
  std::vector<Found> starts;   // where each ended; the first from BondStudy::from, where that is given
  std::vector<Tried> tried;    // by ascending loss
  std::optional<size_t> best;  // of `tried`; none: no set is stable
  uint64_t evaluations = 0;
  const Found& found() const { return starts[tried[*best].start]; }
};

struct BondFitOptions {
  int jobs = 0;  // threads, which leave no mark; 0: one per core
  bool progress = true;
};

// Keeps what was computed in DIR/starts.jsonl and takes it from there: after study::Interrupted, or a kill,
// the same call ends with the same parameters to the last bit. `starts`, `tried` and `enough` may change in
// between.
BondFit run_bond_fit(const BondStudy& study, const std::string& directory, const BondFitOptions& options);

// Descents of one method from the random starts of the study.
struct Compared {
  Method method = Method::lbfgs;
  std::vector<Found> found;
  std::vector<Descent> descents;
  double seconds = 0;  // of one core, all together
};
std::vector<Compared> compare_methods(const BondStudy& study, const BondFitOptions& options);

}  // namespace cuboct::bond_fit
