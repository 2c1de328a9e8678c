// SPDX-License-Identifier: MIT
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {

std::span<const Target> model_targets() {
  static constexpr Target kTargets[] = {
      {"scene", take_scene},         {"rule", take_rule},
      {"potential", take_potential}, {"particles", take_particles},
      {"mesh", take_mesh},           {"trace", take_trace},
      {"hand_over", take_hand_over}, {"checkpoint", take_checkpoint},
  };
  return kTargets;
}

}  // namespace cuboct::fuzz
