// SPDX-License-Identifier: MIT
// What figures owe to the times at which a run is looked at.
#pragma once

#include <string>
#include <vector>

#include "model/trace/figure.h"
#include "model/trace/trace.h"

namespace cuboct::study {

// One line for each figure that moves by more than `most` (relative), or is lost, if every second sample of
// the curves is left out; the last one stays. `dt` in s. Figures that the curves do not hold, or that are 0,
// have no line.
std::vector<std::string> sampling_notes(const std::vector<Figure>& figures, const std::vector<Curve>& curves,
                                        double dt, double most);

}  // namespace cuboct::study
