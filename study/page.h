// SPDX-License-Identifier: MIT
// The report of a study: one page that works offline, and its charts as pictures.
#pragma once

#include <string>
#include <vector>

#include "study/store.h"

namespace cuboct::study {

// No other point is at least as fast and at least as exact. Indices into `outcomes` of points that are done
// and have both numbers, from fast to exact. `error(outcome)` may be nan: not a candidate.
std::vector<size_t> pareto_front(const std::vector<Outcome>& outcomes, double (*error)(const Outcome&));

// One HTML file: charts (zoom, hover with each point's settings), tables, the machine.
void write_page(const Results& results, const std::string& path);
// The same charts as PNG and SVG, made by gnuplot: DIR/<chart>.png, .svg. Their names.
std::vector<std::string> write_charts(const Results& results, const std::string& directory);

}  // namespace cuboct::study
