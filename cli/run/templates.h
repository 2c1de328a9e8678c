// SPDX-License-Identifier: MIT
// The scenes of scenes/templates, built in, for `cuboct new`.
#pragma once

#include <string>

namespace cuboct {

extern const char kTensionScene[];
extern const char kImpactScene[];
extern const char kDropScene[];
extern const char kBeamScene[];
extern const char kGasScene[];
extern const char kMetalScene[];
extern const char kCrackScene[];
extern const char kSheetScene[];
extern const char kReleaseScene[];
extern const char kRuleScene[];

// By its name; InputError with the nearest spelling.
const std::string& template_text(const std::string& name);

}  // namespace cuboct
