// SPDX-License-Identifier: MIT
// How long a synthesis takes, told before it begins.
#pragma once

#include <cstdint>
#include <string>

#include "synth/target.h"

namespace cuboct::synth {

// Of a unit whose cells have so many bits at their outputs: "30 to 120 s". On one core of 2020 to 2025, half
// to twice what docs/reference/synth.md measures ("Stages").
std::string synthesis_time(Family family, uint64_t bits);

}  // namespace cuboct::synth
