// SPDX-License-Identifier: MIT
// What a run must know of an engine of a plan, and the engine that needs nothing but the model.
#pragma once

#include <string>

#include "hw/plan/setup.h"
#include "model/run/integer_run.h"
#include "model/run/record.h"
#include "model/run/state_engine.h"

namespace cuboct {

// All keep references to what they are given.
FixedSetting setting_of(const Scene& scene, const Plan& plan, int threads = 0);

// Where displacements of a fixed engine count from, m: the packing in its integers.
Vec3 packed_place(const Scene& scene, const Plan& plan, uint32_t id);

// The state with which a fixed engine begins: a checkpoint's, or the scene's.
State begin_of(const Scene& scene, const Plan& plan, CheckpointReader* from);

// Of an engine of the fixed rule, but for its making.
EngineKind fixed_kind(const std::string& name, const Scene& scene, const Plan& plan);
// Of one in real numbers; the plan gives its hash and the cells in which speeds are told.
EngineKind real_kind(const std::string& name, const Scene& scene, const Plan& plan, bool floats);

// Of a plan with a program: from a state, by id or by slot; from a checkpoint, or from the scene's body.
std::unique_ptr<IntegerRun> integer_run(const Scene& scene, const Plan& plan, const State& from,
                                        const MakeIntegerEngine& make = {});
std::unique_ptr<IntegerRun> integer_run(const Scene& scene, const Plan& plan, CheckpointReader* from,
                                        const MakeIntegerEngine& make = {});

EngineKind golden_kind(const Scene& scene, const Plan& plan);
// Golden of a plan with a program: what others ask where they cannot tell by themselves.
GoldenIntegers golden_of(const Plan& plan, const State& state);

}  // namespace cuboct
