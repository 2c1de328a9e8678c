// SPDX-License-Identifier: MIT
// The settings that a study varied, found from its outcomes, and how theory expects an error to follow each.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/sweep/measures.h"

namespace cuboct::study {

// How an error grows with a parameter x where that parameter alone makes it.
struct Order {
  std::string label;          // "dt²"
  double power = 0;           // error ~ x^power
  double halvings = 0;        // error ~ 2^(-halvings x): x counts bits
  int degree = 0;             // of the table's polynomials, where this holds for one degree only
  double at(double x) const;  // up to a factor
};

// A set of outcomes that differ in one parameter only (and in what follows from it).
struct Sweep {
  std::vector<size_t> points;  // by ascending x; one per x
};

struct Parameter {
  std::string id;     // of [a-z0-9_.]: "arch.table.index_bits", "dt"
  std::string label;  // for axes, with its unit
  bool logarithmic = false;
  std::vector<std::string> names;  // of its values where they are no numbers; x is then an index into them
  std::vector<double> x;           // [outcome]; nan: not set there, or "auto" among numbers
  std::vector<Sweep> sweeps;       // of at least two points that are done
};

// Those of which there are sweeps: the time step, then keys of the scene, then of the arch, in the order in
// which they occur. Threads are left out: no error depends on them.
std::vector<Parameter> swept_parameters(const Results& results);

// What theory expects of this error; empty where it expects nothing. docs/reference/numeric.md and physics.md
// derive them: the integrators are of second order, of first where velocities make forces; a table of 2^b
// entries and degree g is wrong by its entries' width to the power of g + 1; a format's rounding halves with
// each bit.
std::vector<Order> expected_orders(const Results& results, const Parameter& parameter, const Measure& error);

// Where the line of an order runs: through the least error at the coarsest value that any sweep (of the
// order's degree) has, where this parameter weighs most and all other errors only add. The line's two ends,
// (x, error); none without such points.
using Line = std::pair<std::pair<double, double>, std::pair<double, double>>;
std::optional<Line> order_line(const Results& results, const Parameter& parameter, const Measure& error,
                               const Order& order);

}  // namespace cuboct::study
