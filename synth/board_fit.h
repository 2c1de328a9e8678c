// SPDX-License-Identifier: MIT
// Whether a board's FPGA has room for an emitted lattice and its host link: asked before a project is
// written.
#pragma once

#include <string>

#include "hw/plan/plan.h"
#include "hw/rtl/board.h"
#include "model/contract/state.h"
#include "synth/tool.h"

namespace cuboct::synth {

// How far it was looked into.
enum class FitCheck {
  memories,     // no more than the memories' words was counted: a tool is missing
  synthesised,  // all of it, by yosys and, on ice40, nextpnr's packer
};

// `scene`: its name, for messages. Synthesises only what may have room for its memories; what was measured
// before comes from the cache (Meter). `hears` is the meter's. Throws InputError with the numbers, and how
// many nodes would fit, where there is no room; ToolFailed, Interrupted.
FitCheck check_board_fit(const std::string& scene, const Plan& plan, const State& initial,
                         const BoardChoice& board, const Hears& hears);

}  // namespace cuboct::synth
