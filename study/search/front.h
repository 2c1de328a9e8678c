// SPDX-License-Identifier: MIT
// Which points of a study are worth choosing: the Pareto front of error and speed, and the cheapest point for
// an error that is asked for.
#pragma once

#include <climits>
#include <functional>
#include <vector>

#include "study/sweep/outcome.h"

namespace cuboct::study {

// A number of an outcome; nan: it has none and is no candidate.
using ValueOf = std::function<double(const Outcome&)>;

// Simulated seconds per second of host time.
double default_speed(const Outcome& outcome);

// The points that no other beats: none is as fast and as exact, and better in one of both. Of points that are
// equal in both the first stands for all. Indices into `outcomes` of points that are done and have both
// numbers, from fast to exact. More `speed` is better (give a cost with a minus), less `error` is better.
std::vector<size_t> pareto_front(const std::vector<Outcome>& outcomes, const ValueOf& error,
                                 const ValueOf& speed = default_speed);

// The row of a table: the fastest point whose error is at most 10^exponent; of equally fast ones the most
// exact.
struct Cheapest {
  static constexpr int kExact = INT_MIN;  // as exponent: the error is 0
  int exponent = 0;
  size_t point = 0;  // index into the outcomes
  bool operator==(const Cheapest&) const = default;
};

// From the decade that holds the error of the fastest point down to that of the most exact one, each once:
// decades without a point of their own repeat the one that has to serve for them.
std::vector<Cheapest> cheapest_by_decade(const std::vector<Outcome>& outcomes, const ValueOf& error,
                                         const ValueOf& speed = default_speed);

}  // namespace cuboct::study
