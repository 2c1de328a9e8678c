// SPDX-License-Identifier: MIT
#include "study/machines/machine_front.h"

#include <algorithm>

namespace cuboct::study {
namespace {

// By all objectives: whether all numbers are there.
bool comparable(const MachineStudy& study, const MachineFinding& finding) {
  return finding.done() &&
         std::ranges::all_of(study.minimise, [&](size_t m) { return finding.values[m].there(); });
}

std::vector<double> ends(const MachineStudy& study, const MachineFinding& finding) {
  std::vector<double> high;
  for (const size_t m : study.minimise) high.push_back(finding.values[m].band.high);
  return high;
}

}  // namespace

bool dominates(const MachineStudy& study, const MachineFinding& a, const MachineFinding& b) {
  const bool alike = a.choice.technology == b.choice.technology;
  bool better = false;
  for (const size_t m : study.minimise) {
    const Band x = a.values[m].band, y = b.values[m].band;
    const bool exact = x.low == x.high && y.low == y.high;
    if (alike || exact) {
      if (x.low > y.low || x.high > y.high) return false;
      better = better || x.low < y.low || x.high < y.high;
    } else {
      if (x.high > y.low) return false;
      better = true;
    }
  }
  return better;
}

std::vector<size_t> machine_front(const MachineStudy& study, const std::vector<MachineFinding>& findings) {
  std::vector<size_t> candidates, front;
  for (size_t n = 0; n < findings.size(); ++n)
    if (comparable(study, findings[n]) && verdict_of(study, findings[n]) != Verdict::fails)
      candidates.push_back(n);
  const auto alike = [&](const MachineFinding& a, const MachineFinding& b) {
    return a.choice.technology == b.choice.technology &&
           std::ranges::all_of(study.minimise, [&](size_t m) { return a.values[m] == b.values[m]; });
  };
  for (const size_t n : candidates)
    if (std::ranges::none_of(candidates, [&](size_t k) {
          return dominates(study, findings[k], findings[n]) || (k < n && alike(findings[k], findings[n]));
        }))
      front.push_back(n);
  return front;
}

std::optional<size_t> best_machine(const MachineStudy& study, const std::vector<MachineFinding>& findings,
                                   Verdict worst) {
  std::optional<size_t> best;
  for (size_t n = 0; n < findings.size(); ++n) {
    if (!comparable(study, findings[n]) || verdict_of(study, findings[n]) > worst) continue;
    if (!best || ends(study, findings[n]) < ends(study, findings[*best])) best = n;
  }
  return best;
}

std::optional<size_t> nearest_machine(const MachineStudy& study,
                                      const std::vector<MachineFinding>& findings) {
  std::optional<size_t> nearest;
  double least = 0;
  for (size_t n = 0; n < findings.size(); ++n) {
    if (!findings[n].done()) continue;
    double most = 0;
    for (size_t k = 0; k < study.constraints.size(); ++k)
      most = std::max(most, excess(study.constraints[k], findings[n].kept[k]));
    if (!nearest || most < least) nearest = n, least = most;
  }
  return nearest;
}

}  // namespace cuboct::study
