// SPDX-License-Identifier: MIT
// The engines that a process can hold, behind their one interface.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "emu/gpu/run.h"
#include "emu/lattice/run.h"
#include "hw/engine/engine_kind.h"

namespace cuboct::test {

// A scene, its plan, and what an engine of it refers to.
struct Bed {
  Scene scene;
  Plan plan;
  emu::LatticeChoice one_thread, two_threads;
  gpu::GpuChoice gpu;
};

struct Kind {
  std::string name;
  // For the request that the engine will run.
  std::function<EngineKind(const Bed&, const RunRequest&)> make;
};

inline void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

// All that hold the fixed rule's bits; golden is the first.
const std::vector<Kind>& fixed_kinds();

}  // namespace cuboct::test
