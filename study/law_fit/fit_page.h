// SPDX-License-Identifier: MIT
// A fit as it goes: one page that needs no network, and its charts as pictures.
#pragma once

#include <string>
#include <vector>

#include "study/law_fit/fit.h"

namespace cuboct::fit {

// Curve, law and error by evaluation, drawn by gnuplot; tables. The same fit gives the same bytes. Throws
// InputError where gnuplot is missing.
void write_page(const FitStudy& study, const Fit& fit, const std::string& path);

// The charts as PNG and SVG in a directory that is made where needed: the files' names.
std::vector<std::string> write_charts(const FitStudy& study, const Fit& fit, const std::string& directory);

// "not at all", or "3 % of its bounds".
std::string uncertainty_text(double uncertainty);

// "0.97 push_2_force - 0.2 push_top": weights of 0.2 and more.
std::string combination_text(const Combination& combination, const std::vector<size_t>& free);

}  // namespace cuboct::fit
