// SPDX-License-Identifier: MIT
// What the RTL generator has decided, before any text: constants, tables and wiring. Three passes: decide()
// derives a design from a plan, legalise() refuses what the modules cannot hold, and the printers turn it
// into text.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hw/plan/plan.h"

namespace cuboct {

// A constant of cuboct_pkg; `wide` ones are 64-bit vectors, the others `int`.
struct RtlConstant {
  std::string name;
  int64_t value = 0;
  bool wide = false;
  bool core = false;    // a parameter of cuboct_node_core, or of cuboct_brick_core
  std::string comment;  // unit or meaning
};

// A synchronous read-only memory of {c2, c1, c0}.
struct RtlTable {
  std::string module;
  int entry_bits = 0;
  int index_bits = 0;               // of an address: law, then bin
  std::vector<int32_t> c0, c1, c2;  // c2 is empty at degree 1
};

// Every value that a table can give lies in [low, high].
struct ValueRange {
  int64_t low = 0, high = 0;
};

struct RtlDesign {
  std::string maker;  // first line of every generated file: what made it, from what
  std::vector<RtlConstant> constants;
  std::vector<RtlTable> tables;
  std::vector<FixedType> types;
  std::vector<int>
      moved;  // types whose velocities come from outside (hw/rtl/board.h); decide() leaves it empty
  std::vector<std::vector<int32_t>> scale;  // types x types; empty where the plan has none
  int law_bits = 0;                         // of a law's number; 0: one law
  std::vector<std::vector<uint8_t>> law;    // types x types; empty where there is one law
  int axes = 3;
  int streamers = 1, pipes = 1;
  int rounds = 1;
  bool text = false;  // a rule of text
  // Of it: what cuboct_rule_core is told besides the constants. The emission adds it.
  std::vector<std::pair<std::string, std::string>> rule;
  bool arrival = false;  // halos are used as they come
  int type_bits = 0;
  int velocity_bits = 0;
  int particle_bits = 0, link_bits = 0;
  bool checked = false;     // links have a check: cuboct_link_guard, and the ports of link_ack and link_error
  int pair_sum_bits = 0;    // of a pipe's exact sum
  std::vector<Cell> cells;  // of the nodes; of bricks their lowest ones
  std::vector<std::array<uint32_t, kFaces>> neighbour;
  int cell_bits = 0;                 // of a cell's number in its brick; 0: nodes of one cell
  std::vector<std::string> extents;  // of bricks, by node: constants of extent_i and exit_i, sized and binary
  std::vector<std::string> exits;

  bool bricks() const { return cell_bits > 0; }
};

// Inputs of a node with a brick that never change: its cells along x, y, z, ceil(log2(longest + 2)) bits
// each, and, by cell and face, whether the lattice has a cell there. Least significant bit first.
std::vector<bool> extent_bits(const Plan& plan, uint32_t node);
std::vector<bool> exit_bits(const Plan& plan, uint32_t node);

ValueRange table_range(const FixedTable& table);

RtlDesign decide(const Plan& plan);
// Throws InputError with the numbers.
void legalise(const RtlDesign& design, bool with_lattice);

std::string head(const RtlDesign& design);  // comment lines at the top of each generated file
std::string print_package(const RtlDesign& design);
std::string print_table(const RtlDesign& design, const RtlTable& table);
std::string print_scale(const RtlDesign& design);  // cuboct_scale_rom
std::string print_types(const RtlDesign& design);  // cuboct_type_rom
// Of design.moved, as one vector: type by type, axis 0 in the least significant place; one bit where none is.
std::string print_velocities(const RtlDesign& design);
int velocities_bits(const RtlDesign& design);
std::string print_node(const RtlDesign& design);      // cuboct_node
std::string print_node_box(const RtlDesign& design);  // its ports alone, to lint a lattice of many nodes
std::string print_lattice(const RtlDesign& design);

}  // namespace cuboct
