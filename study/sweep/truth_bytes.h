// SPDX-License-Identifier: MIT
// A truth as bytes and back, exact to the last bit: a study that goes on compares with the same numbers.
#pragma once

#include <string>

#include "study/sweep/truth.h"

namespace cuboct::study {

std::string bytes_of(const Truth& truth);
// Throws InputError where the bytes end early.
Truth truth_of(const std::string& bytes);

}  // namespace cuboct::study
