// SPDX-License-Identifier: MIT
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {

std::span<const Target> machine_targets() {
  static constexpr Target kTargets[] = {
      {"plan", take_plan},   {"arch", take_arch},       {"technology", take_technology},
      {"board", take_board}, {"liberty", take_liberty}, {"json", take_json},
  };
  return kTargets;
}

}  // namespace cuboct::fuzz
