// SPDX-License-Identifier: MIT
// What a node is made of, in transistors at work: independent of any device and of the tools for it.
#pragma once

#include "hw/cost/pair_work.h"
#include "hw/plan/plan.h"
#include "model/contract/rule.h"

namespace cuboct {

// Transistors in static CMOS: of a bit product, an AND gate and a full adder (6 + 28); of a bit of an adder
// or comparator; of a bit of memory, an SRAM cell. Weste and Harris, CMOS VLSI Design, 4th ed., sections 11.2
// and 12.2.
inline constexpr double kBitProduct = 34, kAdderBit = 28, kMemoryBit = 6;

// The node of docs/reference/node.md, counted from the widths of its RTL (rtl/lib). Registers and control are
// left out: they go with the same widths.
struct NodeArea {
  double multipliers = 0;  // of the pair pipes, and of update where a type is held by force
  double tables = 0;       // force, and damping where the scene damps, of each pipe
  double adders = 0;       // of filter lanes, pipes and update
  double particles = 0;    // memory of slots, arrivals, halos, queue and sums

  double transistors() const { return multipliers + tables + adders + particles; }
};
NodeArea area_of(const Plan& plan);
// Of this work alone, without `particles`: a multiplier, an adder for each that the work names.
NodeArea logic_of(const DatapathWork& work, const Arch& arch);
// Bits of a node's memories of particles, halos, queue and sums: NodeArea::particles over a cell's 6.
double memory_bits(const Plan& plan);
// The same node with all numbers as floats of `mantissa` bits (53, 24) and `bits` of storage (64, 32): a law
// by a cubic in r, so with a square root and a division, each counted as one product; an adder of floats as
// three of its mantissa's (align, add, normalise).
NodeArea area_of(const Rule& rule, const Arch& arch, int mantissa, int bits);

}  // namespace cuboct
