// SPDX-License-Identifier: MIT
// Random orientations, of grains.
#pragma once
#include <random>

#include "model/base/mat3.h"

namespace cuboct {

// Any rotation, all alike in chance; the same on every machine.
Mat3 random_turn(std::mt19937_64& generator);

}  // namespace cuboct
