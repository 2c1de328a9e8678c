// SPDX-License-Identifier: MIT
// Two to sixteen small nodes, narrow formats, short tables, records of several beats: netlists and changed
// modules of them are made and simulated in seconds. Between them they use every path of rtl/lib.
#pragma once

#include <string>
#include <vector>

#include "tests/support/cases.h"

namespace cuboct::test {

std::vector<std::string> small_names();

// One of small_names(). Throws std::out_of_range.
Case small_case(const std::string& name);

}  // namespace cuboct::test
