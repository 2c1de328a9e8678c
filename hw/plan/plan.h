// SPDX-License-Identifier: MIT
// All that an engine needs: immutable, printable, hashed.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hw/arch/arch.h"
#include "hw/arch/auto_widths.h"
#include "hw/arch/bricks.h"
#include "hw/arch/words.h"
#include "model/contract/fixed_rule.h"
#include "model/contract/lattice.h"
#include "model/contract/state.h"

namespace cuboct {

struct IntegerProgram;  // model/program/integer_program.h

// Registers of the filter with wide memories: a candidate's answer, the one chosen, sizes, masks.
inline constexpr int kFilterStages = 4;
// Registers of the cull on arrival: the record, its distances from the box of the own particles, the tests.
inline constexpr int kCullStages = 3;

// Fixed latencies of the datapath, in cycles; they depend only on what the rule uses and on the kind of
// multipliers. docs/reference/node.md.
struct Latency {
  int filter =
      kFilterStages;  // from the candidate's read to its push into the queue; a register more on arrival
  int pipe = 0;       // from a pair's issue to its sum
  int update = 0;     // from a particle's read to the cycle in which MIGRATE may read it
  int stride =
      1;  // from one particle's read to the next in UPDATE: narrow memories keep each until it is written
  int interval = 1;  // from one issue of pairs to the next
  int product = 1;   // of the pipe's multipliers; 2 with registers on both sides, more where they are serial
};

// What a round of the rule asks of a node. The pair law has one.
struct PlanRound {
  WordLayout record;  // of a halo: of the first round Words::halo, of a later one its fields alone
  int beats = 0;      // of it; 0 where nothing is sent
  int pipe = 0;       // from a pair's issue to its sum
  int finish = 0;     // from a particle's read to the cycle in which its result may be read
};

struct Plan {
  FixedRule rule;
  Arch arch;                   // as built: nothing in it is automatic
  Lattice lattice;             // of cells
  Bricks bricks;               // of these: what each physical node serves
  Vec3 origin = Vec3::Zero();  // m, lower corner of cell (0,0,0)
  Words words;
  Latency latency;
  std::vector<PlanRound> rounds;  // one at least
  LinkCode link;
  std::vector<uint8_t> cut;  // by node, bit f: the link over face f leads to another device; empty on one
  uint32_t particles = 0;
  // Of a rule that is text; null: the pair law's formats are in `rule`.
  std::shared_ptr<const IntegerProgram> program;
  uint64_t hash = 0;  // of everything above that an engine can see
  // For people: why formats and capacity are what they are, and what they cannot do.
  std::vector<WidthReason> reasons;
  std::vector<std::string> warnings;

  // Of the machine's nodes. The neighbour over a face may be kNoNode.
  uint32_t nodes() const { return bricks.size(); }
  uint32_t neighbour(uint32_t node, int face) const { return bricks.neighbour(lattice, node, face); }
  // Coordinates of a node's lowest cell.
  Cell low_of(uint32_t node) const { return bricks.low(lattice, node); }
  // Whether the link of a node over a face leads to another device.
  bool crosses(uint32_t node, int face) const { return !cut.empty() && (cut[node] >> face & 1) != 0; }
  uint32_t node_of(uint32_t cell) const { return bricks.node_of(cell); }
  uint32_t local_of(uint32_t cell) const { return bricks.local_of(cell); }
  // The lattice's cell number `local` of a node, or kNoCell.
  uint32_t cell_of(uint32_t node, uint32_t local) const { return bricks.cell(node, local); }
  // The first of the lattice's cells that a node has.
  uint32_t first_cell_of(uint32_t node) const {
    uint32_t local = 0;
    while (cell_of(node, local) == kNoCell) ++local;
    return cell_of(node, local);
  }
};

Latency latency_of(const FixedRule& rule, const Arch& arch);
// Cells of the smallest box that holds the lattice.
uint64_t bounding_cells(const Lattice& lattice);

// Derives words, latency and hash. Throws InputError where the arch cannot work (a capacity below 1, narrow
// memories with more than one lane or pipe, or with overlap, ...).
Plan make_plan(FixedRule rule, Arch arch, Lattice lattice, const Vec3& origin, uint32_t particles);

// The rule and the particles of `plan` on another machine.
Plan on_machine(const Plan& plan, Arch arch, Lattice lattice);
inline Plan on_machine(const Plan& plan, Arch arch) {
  return on_machine(plan, std::move(arch), plan.lattice);
}

// Gives the plan the words, rounds and latencies of `program`, which it keeps, and the hash that follows.
void set_program(Plan& plan, std::shared_ptr<const IntegerProgram> program);
// Why the machine that the plan describes does not run its rule: one line for people. Empty where it does.
std::string machine_refusal(const Plan& plan);

// The lines of `describe` that tell of a plan's program: its fields, and what each round sends and takes.
void describe_rounds(const Plan& plan, const std::function<void(const char*, const std::string&)>& line);

// Phase spans of a step of the machine: of all its nodes.
size_t spans_of_step(const Plan& plan);

// The plan as text, for people and for diffs; no dates, no addresses.
std::string describe(const Plan& plan);

}  // namespace cuboct
