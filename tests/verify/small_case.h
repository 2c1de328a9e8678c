// SPDX-License-Identifier: MIT
// Two to four small nodes, narrow formats, short tables, records of several beats: netlists and changed
// modules of them are made and simulated in seconds.
#pragma once

#include <string>

#include "tests/support/cases.h"

namespace cuboct::test {

// plain, damped (and scaled, held, two pipes), pd (parabolas, no overlap), flat. Throws std::out_of_range.
Case small_case(const std::string& name);

}  // namespace cuboct::test
