// SPDX-License-Identifier: MIT
// What a machine's nodes take of an FPGA, before any synthesis: bands, for sweeps of very many machines.
// docs/reference/synth.md, "Before any synthesis", has the nodes that the bands were drawn around.
#pragma once

#include <optional>

#include "hw/cost/technology.h"
#include "hw/plan/plan.h"
#include "synth/target.h"

namespace cuboct::synth {

struct NodeEstimate {
  Band lut, ff, dsp, bram;  // of one node
};

// Nothing of families and nodes that the bands were not drawn around: other FPGAs than ECP5, narrow memories.
std::optional<NodeEstimate> estimate_node(const Plan& plan, const Target& target);

// The largest share of the room that a plan should use (planned_share), of all nodes.
Band share_of_room(const NodeEstimate& node, double nodes, const Target& target);

// What the logic of a node is counted in: bits of its adders, of the operands of serial products, and of the
// registers of its links. For the calibration.
double logic_bits(const Plan& plan);

}  // namespace cuboct::synth
