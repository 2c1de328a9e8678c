// SPDX-License-Identifier: MIT
// Energy and area of a plan's machine: exact counts of events (hw/cost/events.h) times the figures of a
// technology (hw/cost/technology.h). Each result is a band; what no figure covers is named, never counted as
// nothing. docs/reference/energy.md has each term's formula.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hw/cost/events.h"
#include "hw/cost/memory_traffic.h"
#include "hw/cost/technology.h"
#include "hw/plan/plan.h"

namespace cuboct {

struct EnergyRow {
  std::string term;    // "pairs: products"
  double events = 0;   // how often
  std::string of;      // what is counted: "pairs"
  Band picojoules;     // of all of them
  std::string source;  // of its constant
};

struct Energy {
  std::vector<EnergyRow> rows;
  Band sum;                          // pJ, of the rows
  std::vector<std::string> missing;  // terms that are not in the sum, and why
};

// `events`: summed over the nodes; `traffic`: likewise; `cycles`: of the run, every node is clocked in each;
// `clock`, Hz. Throws std::invalid_argument where the clock is not positive, or a count is above what the
// plan can do in so many cycles.
Energy energy_of(const Plan& plan, const MachineEvents& events, std::span<const MemoryTraffic> traffic,
                 uint64_t cycles, double clock, const Technology& technology);

struct AreaRow {
  std::string part;
  Band mm2;  // of all nodes
  std::string source;
};
struct Area {
  std::vector<AreaRow> rows;
  Band sum;  // mm^2; without anything missing also that of `rows`
  std::vector<std::string> missing;
  Band side;  // mm, of a node, if it is square
};
Area area_of(const Plan& plan, const Technology& technology);

// Bits of registers of a node: what the datapath and the links need, times what five synthesised nodes have
// over that (docs/reference/energy.md).
Band register_bits(const Plan& plan);

// pJ of a bit of a memory of so many words.
Band memory_bit_energy(const TechnologyFigure& figure, const TechnologyFigure& exponent, double words);

// The sum with one constant at its ends and all others in the middle of their bands: the longest bar first.
struct Sensitivity {
  Constant constant;
  double low = 0, high = 0;  // pJ
};
std::vector<Sensitivity> sensitivity_of(const Plan& plan, const MachineEvents& events,
                                        std::span<const MemoryTraffic> traffic, uint64_t cycles, double clock,
                                        const Technology& technology);

}  // namespace cuboct
