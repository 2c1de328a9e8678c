// SPDX-License-Identifier: MIT
// Curves as a table of comma-separated values (RFC 4180), for pandas, gnuplot and spreadsheets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/trace/trace.h"

namespace cuboct {

// A line for each step at which any curve has a sample: the step, with `dt` (s) the time, then each curve's
// value, empty where it has none. The first line names them, with units: "time (s)", "tension.stress (Pa)";
// a plain number has none, and without `units` nothing has. Values are written so that they are read back as
// they are.
std::string curves_csv(const std::vector<Curve>& curves, std::optional<double> dt, bool units = true);

}  // namespace cuboct
