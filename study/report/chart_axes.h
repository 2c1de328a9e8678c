// SPDX-License-Identifier: MIT
// Ranges and ticks around what a chart draws.
#pragma once

#include "study/report/chart.h"

namespace cuboct::study {

// `drawn` of the values make the range.
// Whole decades. Where a value is 0, one decade more below stands for it.
ChartAxis decades_axis(const std::string& label, std::vector<double> values, const Rows& drawn);
// Close around the values: logarithmic with ticks at 1, 2 and 5, or plain with ticks at the values.
ChartAxis close_axis(const std::string& label, std::vector<double> values, const Rows& drawn,
                     bool logarithmic);
// Of names, at 0, 1, 2 ...
ChartAxis named_axis(const std::string& label, std::vector<double> values,
                     const std::vector<std::string>& names);

}  // namespace cuboct::study
