// SPDX-License-Identifier: MIT
// The fit to the evenly deformed packing: where the search with virtual tests begins.
#pragma once

#include "study/law_fit/fit_study.h"

namespace cuboct::fit {

// Stress of the packing with some law, Pa.
std::vector<double> packing_curve(const FitStudy& study, const Parameters& parameters,
                                  const std::vector<double>& strains);

// Pa, of the undeformed packing.
double packing_pressure(const FitStudy& study, const Parameters& parameters);

// The law whose packing comes nearest to the target up to its largest stress, by the same search as that of
// virtual tests, in about a second. Deterministic.
Parameters fit_packing(const FitStudy& study);

}  // namespace cuboct::fit
