// SPDX-License-Identifier: MIT
// The page of a study of machines, like that of study/report/page.h.
#pragma once

#include <string>

#include "study/machines/machine_charts.h"

namespace cuboct::study {

// The same results give the same bytes. Throws std::logic_error where the build has no page (has_page).
std::string machine_page_of(const MachineResults& results);

}  // namespace cuboct::study
