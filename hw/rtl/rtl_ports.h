// SPDX-License-Identifier: MIT
// The ports of the emitted modules, as data: the printers, the bench and the project's README read these
// lists, and docs/reference/node.md and links.md are held to them by a test.
#pragma once

#include <string>
#include <vector>

#include "hw/rtl/rtl_design.h"

namespace cuboct {

struct RtlPort {
  bool output;
  std::string name;
  std::string bits;  // a number, or an expression of cuboct_pkg's constants, of a lattice of `ProbeNodes` too
  std::string meaning;
};

// Of cuboct_node; `core`: of the core within, whose links are not checked.
std::vector<RtlPort> node_ports(const RtlDesign& design, bool core);
// Of cuboct_lattice: the host's side, and probe_X for each output X of its nodes that is not a link's.
std::vector<RtlPort> lattice_ports(const RtlDesign& design);

// "[7:0] " with a blank, or nothing for one bit.
std::string range_of(const RtlPort& port);
std::string print_ports(const std::vector<RtlPort>& ports);

}  // namespace cuboct
