// SPDX-License-Identifier: MIT
// The last state that a trace of `cuboct run` holds, with all that its numbers need to mean something
// elsewhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/contract/state.h"

namespace cuboct {

struct LeftState {
  std::string engine;
  uint64_t step = 0;
  uint64_t first_step = 0;         // of a rule of text: the steps of runs that this one went on from
  uint64_t packing = 0;            // model/trace/trace_head.h
  Vec3 box_strain = Vec3::Zero();  // 1, at `step`, of the box as packed
  std::vector<std::string> types;  // names, "material" or "material/constraint"
  // By id, in SI; of a fixed engine with its integers in `exact`. `u` is empty where nothing is held by
  // force. `bonds` do not say where they count from: that is the packing.
  Body body;
};

// Throws InputError where the file is no trace of `cuboct run`, holds no state, or is damaged.
LeftState read_left_state(const std::string& path);

}  // namespace cuboct
