// SPDX-License-Identifier: MIT
#include "study/search/front.h"

#include <algorithm>
#include <cmath>

namespace cuboct::study {
namespace {

// The least e with error <= 10^e. The logarithm of a number just above a power of ten rounds down to a whole
// one.
int decade_of(double error) {
  int e = static_cast<int>(std::ceil(std::log10(error)));
  while (error > std::pow(10.0, e)) ++e;
  return e;
}

}  // namespace

double default_speed(const Outcome& outcome) { return outcome.speed.simulated_seconds; }

std::vector<size_t> pareto_front(const std::vector<Outcome>& outcomes, const ValueOf& error,
                                 const ValueOf& speed) {
  struct Candidate {
    double error, speed;
    size_t point;
  };
  std::vector<Candidate> candidates;
  for (size_t n = 0; n < outcomes.size(); ++n) {
    if (outcomes[n].status != Status::done) continue;
    const Candidate c{error(outcomes[n]), speed(outcomes[n]), n};
    if (std::isfinite(c.error) && std::isfinite(c.speed)) candidates.push_back(c);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.speed != b.speed ? a.speed > b.speed : a.error < b.error;
  });
  std::vector<size_t> front;
  double least = INFINITY;
  for (const Candidate& c : candidates)
    if (c.error < least) {
      least = c.error;
      front.push_back(c.point);
    }
  return front;
}

std::vector<Cheapest> cheapest_by_decade(const std::vector<Outcome>& outcomes, const ValueOf& error,
                                         const ValueOf& speed) {
  const std::vector<size_t> front = pareto_front(outcomes, error, speed);
  std::vector<Cheapest> rows;
  for (const size_t point : front) {
    const double e = error(outcomes[point]);
    if (e <= 0) {
      rows.push_back({Cheapest::kExact, point});
      continue;
    }
    const int decade = decade_of(e);
    if (rows.empty()) rows.push_back({decade, point});
    while (rows.back().exponent > decade) rows.push_back({rows.back().exponent - 1, point});
  }
  return rows;
}

}  // namespace cuboct::study
