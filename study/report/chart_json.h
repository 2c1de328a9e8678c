// SPDX-License-Identifier: MIT
// Charts and frames of pages, as study/report/web/*.js read them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "study/report/chart.h"

namespace cuboct::study {

// Charts name their values by an index into `columns`, which grows: several share one.
std::string charts_json(const std::vector<Chart>& charts, std::vector<std::string>& columns);

// The frame with its places "@name@", in their order, filled.
std::string filled_frame(std::string_view frame,
                         const std::vector<std::pair<const char*, std::string>>& parts);

}  // namespace cuboct::study
