// SPDX-License-Identifier: MIT
// The cheapest settings within an error budget. Knows nothing of scenes: settings are notches on axes, and
// two functions say what a point's error and cost are.
//
// An error alone is a bad witness: a coarse step and a coarse table may each be wrong by 2 % and together by
// 0.1 %, until a velocity changes. So what is held against the budget is a sum of parts, as in an engineer's
// error budget. On the way from the reference (the finest settings) to a point the axes are coarsened one
// after another, in their order, the others staying as fine as they are; the part of an axis is the largest
// change of the figure that its notch or any finer one makes there. Then
//
//   |error(point)| <= |error(reference)| + sum of parts =: sum(point)
//
// and a point keeps the budget if its sum does. Neither two axes nor two notches of one can hide each other's
// error; a notch below one that breaks the budget never counts; the sum never falls when a setting gets
// cheaper on a given way. Axes come in the order of the list, so that what changes the problem (pitch, time
// step) stands first and the formats that come later are judged at the step that they will run with.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <vector>

namespace cuboct::study {

// Of each axis, the place on it: 0 is the cheapest.
using Notches = std::vector<int>;

struct SearchSpace {
  std::vector<int> sizes;  // notches of each axis, at least 1
  // Of each point (no point is asked for twice): the figure's relative error with its sign; nan where these
  // settings cannot be run.
  std::function<std::vector<double>(const std::vector<Notches>&)> errors;
  // Must not fall from a notch to the next. nan where there is none: the settings fit no machine.
  std::function<double(const Notches&)> cost;
  // The same settings with the axes that do not matter at this point (widths, to doubles) at their finest
  // notch. May be empty: all matter.
  std::function<Notches(const Notches&)> finest_alike;
};

// What a point takes of the budget.
struct Spending {
  Notches at;
  double error = 0;           // with its sign, as measured; nan: cannot be run
  std::vector<double> parts;  // of each axis; fewer where the budget is broken before the last axis
  double sum = 0;             // |error of the reference| + parts; inf: some settings on the way cannot be run
};

struct SearchResult {
  bool met = false;
  Notches reference;           // the finest settings, or those near them that are more exact (search.cpp)
  double reference_error = 0;  // with its sign
  Spending best;               // met: the cheapest point. Else: the reference
  double cost = 0;             // of `best`
  // Not met, though the reference keeps the budget: a finer notch next to it does not, so that its small
  // error is a zero between errors of either sign.
  bool accident = false;
  // met: for each axis that matters at `best` and is not at its cheapest notch there, `best` with that axis
  // one notch cheaper.
  struct Cheaper {
    size_t axis = 0;
    Spending spending;  // its sum is above the budget
  };
  std::vector<Cheaper> cheaper;
  // not met: the axis of which a notch next to the reference's changes the size of the error the most, by
  // `limit_change`: the one that would have to be finer. -1: none can be told.
  int limit = -1;
  double limit_change = 0;
  size_t measured = 0;  // points
};

// The notches of an axis do not go from cheap to dear.
class NotchOrder : public std::runtime_error {
 public:
  NotchOrder(size_t axis, int notch);
  size_t axis;
  int notch;  // costs more than the one after it
};

// The point of least cost whose sum is within `budget` (> 0); of equal costs the one with the lower notches.
// So no single axis of it can go one notch cheaper. Exact, by best-first search.
SearchResult search(const SearchSpace& space, double budget);

}  // namespace cuboct::study
