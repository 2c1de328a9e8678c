// SPDX-License-Identifier: MIT
#include "hw/engine/rounds_kind.h"

#include "model/run/rounds_run.h"

namespace cuboct {

EngineKind rounds_kind(const Scene& scene, const Plan& plan, const RealOptions& options) {
  EngineKind kind = rounds_kind(scene, scene.body, options, plan.rule.cell_edge);
  kind.plan_hash = plan.hash;
  kind.nodes = 0;
  return kind;
}

}  // namespace cuboct
