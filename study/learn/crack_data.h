// SPDX-License-Identifier: MIT
// What atoms did in sheets that crack, kept in a file.
#pragma once

#include <array>

#include "study/learn/fracture_samples.h"

namespace cuboct::learn {

// Of each FractureLoad. DIR/cracks.jsonl keeps them. Throws study::Interrupted; InputError where the file is
// of another study.
std::array<FractureSample, 2> cracked_sheets(const LearnStudy& study, const std::string& directory, int jobs);

}  // namespace cuboct::learn
