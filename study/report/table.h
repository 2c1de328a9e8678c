// SPDX-License-Identifier: MIT
// Results as text.
#pragma once

#include <string>

#include "study/sweep/store.h"

namespace cuboct::study {

// What of the settings differs from point to point, in one line: "fixed dt_safety 0.1 guard 6".
std::string short_name(const Settings& settings);

// For each decade of the error that counts, the fastest point at least as exact (where no speed was measured:
// the one of least cost). The error: of the worst figure, in studies without figures of the trajectory.
std::string cheapest_per_decade(const Results& results);
// The same rows as an array of JSON.
std::string cheapest_json(const Results& results);
// The truth: rungs, horizon, notes.
std::string describe(const Truth& truth, const Results& results);

}  // namespace cuboct::study
