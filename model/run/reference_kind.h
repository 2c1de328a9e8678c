// SPDX-License-Identifier: MIT
// The reference engine that a scene needs: at rest after each load step, by rounds, or by pairs.
#pragma once

#include <memory>
#include <vector>

#include "model/real/reference.h"
#include "model/run/record.h"

namespace cuboct {

// From `start` instead of the scene's body; keeps references to both. `cell_edge`: m, in which speeds are
// told. InputError for floats, or velocity Verlet, which static loading has not.
EngineKind scene_reference_kind(const Scene& scene, const Body& start, const RealOptions& options,
                                double cell_edge);
// The same engine in the state `body` of step `step`. `own`: Engine::memory().own of the engine that left it
// there; empty: the run begins.
std::unique_ptr<Engine> scene_reference(const Scene& scene, const Body& body, const RealOptions& options,
                                        double cell_edge, uint64_t step, const std::vector<uint64_t>& own);

}  // namespace cuboct
