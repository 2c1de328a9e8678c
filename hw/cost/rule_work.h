// SPDX-License-Identifier: MIT
// The work and the memories of a node that runs a rule of text, read off its rounds' schedules and off the
// words of its plan. rtl/rounds/cuboct_rule_core.sv has them.
#pragma once

#include <vector>

#include "hw/cost/events.h"
#include "hw/cost/memory_traffic.h"
#include "hw/cost/node_memories.h"
#include "hw/cost/pair_work.h"
#include "hw/plan/plan.h"

namespace cuboct {

// As datapath_work (pair_work.h): `pair` is one pair in each round, `update` one particle's finish of each
// round, summed over the rounds.
DatapathWork rule_work(const Plan& plan);

// Bits of registers of a node that hold what its pairs leave of their bonds until the finish: which were met,
// and their numbers.
double bond_register_bits(const Plan& plan);

// Bits of a receiver's registers: of the widest that comes over a face, particles or a round's records.
int received_bits(const Plan& plan);

// The memories of the plan's node with its lanes and pipes, the tables among them.
std::vector<NodeMemory> rule_memories(const Plan& plan);

// As memory_traffic (memory_traffic.h), with the tables. What a pair reads and adds to a sum is counted of
// each issued pair, which is an upper end. A later round's numbers of a halo count as used in its round and
// those behind it.
std::vector<MemoryTraffic> rule_traffic(const Plan& plan, const MachineEvents& events);

}  // namespace cuboct
