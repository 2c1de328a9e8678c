// SPDX-License-Identifier: MIT
#include "study/machines/machine_evolution.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "model/base/error.h"
#include "model/base/module.h"
#include "study/machines/machine_front.h"

namespace cuboct::study {
namespace {

// Of an objective of what is no machine, and of constraints that are missed: more than any real one.
constexpr double kNoMachine = 1e30, kMissed = 1e15;

EvolveNotches* find_evolver() {
  if (void* evolver = module_symbol(kNotchModule, kEvolveNotches))
    return reinterpret_cast<EvolveNotches*>(evolver);
  throw InputError(std::string("no module ") + kNotchModule + ", which [evolve] needs",
                   "it is built beside cuboct where pagmo (libpagmo-dev) is found");
}

// By how much constraints are broken for certain, summed; 0: none is.
double missed(const MachineStudy& study, const MachineFinding& f) {
  double sum = 0;
  for (size_t k = 0; k < study.constraints.size(); ++k)
    if (judge(study.constraints[k], f.kept[k]) == Verdict::fails)
      sum += std::abs(std::log(excess(study.constraints[k], f.kept[k])));
  return sum;
}

// Bands by the middle of their ends' logarithms.
std::vector<double> worth_of(const MachineStudy& study, const MachineFinding& f) {
  std::vector<double> worth;
  const double behind = f.done() ? missed(study, f) : 0;
  for (const size_t m : study.minimise) {
    const bool there = f.done() && f.values[m].there();
    const double value = there ? std::sqrt(f.values[m].band.low * f.values[m].band.high) : kNoMachine;
    worth.push_back(behind > 0 ? kMissed * (1 + behind) : value);
  }
  return worth;
}

}  // namespace

Evolved evolve_machines(const MachineStudy& study, MachineRunner& runner) {
  const MachineEvolution& evolution = *study.evolution;
  const uint64_t screen = std::min(kScreenSteps, study.steps);
  std::map<std::vector<size_t>, size_t> at;  // of `seen`
  std::vector<MachineFinding> seen;
  NotchEvolution search{evolution.space.sizes,
                        study.minimise.size(),
                        static_cast<unsigned>(evolution.population),
                        static_cast<unsigned>(evolution.generations),
                        evolution.seed,
                        {}};
  search.worth = [&](const std::vector<std::vector<size_t>>& points) {
    std::vector<MachineChoice> fresh;
    for (const auto& notches : points)
      if (at.emplace(notches, seen.size() + fresh.size()).second)
        fresh.push_back(evolution.space.at(notches));
    for (MachineFinding& f : runner.evaluate(fresh, screen)) seen.push_back(std::move(f));
    std::vector<std::vector<double>> worth;
    for (const auto& notches : points) worth.push_back(worth_of(study, seen[at.at(notches)]));
    return worth;
  };
  find_evolver()(search);
  Evolved evolved;
  evolved.visited = seen.size();
  for (;;) {
    const std::vector<size_t> front = machine_front(study, seen);
    std::vector<size_t> guessed;
    std::ranges::copy_if(front, std::back_inserter(guessed), [&](size_t n) { return seen[n].screened; });
    if (guessed.empty()) {
      for (const size_t n : front) evolved.front.push_back(seen[n]);
      return evolved;
    }
    std::vector<MachineChoice> again;
    for (const size_t n : guessed) again.push_back(seen[n].choice);
    std::vector<MachineFinding> exact = runner.evaluate(again, study.steps);
    for (size_t k = 0; k < guessed.size(); ++k) seen[guessed[k]] = std::move(exact[k]);
  }
}

}  // namespace cuboct::study
