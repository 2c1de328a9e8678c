// SPDX-License-Identifier: MIT
// Random scenes on random machines with random stalls, for the RTL: those of tests/support/cases.h, and
// beside them what runs into trouble: narrow formats, full cells, fast particles, short queues, links that
// fail.
#pragma once

#include <map>
#include <string>

#include "tests/verify/judge.h"

namespace cuboct::test {

struct RandomScene {
  Case c;
  std::vector<Judge::Run> runs;  // the first without stalls, the second with
};
// Throws InputError where what was drawn is refused.
RandomScene random_scene(uint64_t seed);

// What a judged scene was a stimulus of: names in a fixed order, 0 or 1 or how often.
std::map<std::string, uint64_t> stimuli_of(const RandomScene& scene, const Judge& judge);

}  // namespace cuboct::test
