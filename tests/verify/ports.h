// SPDX-License-Identifier: MIT
// What two implementations of a node show and load, compared port by port in each cycle.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "emu/machine/node_model.h"

namespace cuboct::test {

// Groups of ports that are compared by themselves.
enum class PortGroup { phases, idle, observe, fault, links, acks, count };
const char* to_string(PortGroup group);

// A word per group: a hash where the group is wide. Data counts only where its valid is set.
using Shown = std::array<uint64_t, static_cast<size_t>(PortGroup::count)>;

// [node][cycle after reset]
using PortRecord = std::vector<std::vector<Shown>>;

// The nodes of `factory`; what they show goes to `record`, which has to outlive them and holds a list per
// node.
emu::NodeFactory recorded(emu::NodeFactory factory, PortRecord& record);

// The nodes of `factory`. Throws std::runtime_error, with kPortsDiffer and a group's name in its text, in the
// first cycle in which one shows other than `expected`, which has to outlive them; cycles that were compared
// are counted.
emu::NodeFactory watched(emu::NodeFactory factory, const PortRecord& expected, uint64_t& cycles);
inline constexpr const char* kPortsDiffer = "differs from the native node's: ";

}  // namespace cuboct::test
