// SPDX-License-Identifier: MIT
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {

std::span<const Target> study_targets() {
  static constexpr Target kTargets[] = {
      {"study", take_study},
      {"results", take_results},
      {"words", take_words},
  };
  return kTargets;
}

}  // namespace cuboct::fuzz
