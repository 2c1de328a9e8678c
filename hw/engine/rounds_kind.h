// SPDX-License-Identifier: MIT
// What a run must know of an engine whose rule has several rounds.
#pragma once

#include "hw/plan/plan.h"
#include "model/real/reference.h"
#include "model/run/record.h"

namespace cuboct {

// With what stands for its plan (hw/plan/real_plan.h).
EngineKind rounds_kind(const Scene& scene, const Plan& plan, const RealOptions& options);

}  // namespace cuboct
