// SPDX-License-Identifier: MIT
// Charts of pages, as study/report/web/*.js read them.
#pragma once

#include <string>
#include <vector>

#include "study/report/chart.h"

namespace cuboct::study {

// Charts name their values by an index into `columns`, which grows: several share one.
std::string charts_json(const std::vector<Chart>& charts, std::vector<std::string>& columns);

}  // namespace cuboct::study
