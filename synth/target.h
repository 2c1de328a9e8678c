// SPDX-License-Identifier: MIT
// What a project can be synthesised for: devices, what they hold, and what each cell of their netlists costs.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cuboct::synth {

enum class Family { ice40, ecp5, xc7, asic };

// LUTs: sites with four inputs (six in xc7), those that serve as carries or memory too. BRAM: blocks of 4
// kbit (ice40) or 18 kbit. Cells: of ice40, a LUT and a flip-flop. Gates and area, in um^2: of standard
// cells.
enum class Resource { lut, ff, dsp, bram, gates, area, cell };
const char* to_string(Resource resource);
// Those of a family, in the order in which tables show them.
const std::vector<Resource>& resources_of(Family family);

struct Counts {
  std::array<uint64_t, 7> of{};  // by Resource

  uint64_t operator[](Resource r) const { return of[static_cast<size_t>(r)]; }
  uint64_t& operator[](Resource r) { return of[static_cast<size_t>(r)]; }
  Counts& operator+=(const Counts& other);
  bool operator==(const Counts&) const = default;
};

struct Target {
  std::string name;
  Family family;
  std::string device;   // as its maker calls it; what the numbers below are of
  std::string package;  // of the device, for placing
  Counts holds;
  double frequency = 0;  // MHz that placing aims at
};

const std::vector<Target>& targets();
// Throws InputError with a hint that lists them.
const Target& target_of(const std::string& name);

// The share of a resource that a plan should use. ECP5 at 100 % of its DSPs loses four tenths of its clock.
double planned_share(const Target& target, Resource resource);

// What a cell of a netlist occupies; nothing where the type is not known.
using CostOf = std::function<std::optional<Counts>(const std::string& cell_type)>;
CostOf costs_of(Family family);  // of an FPGA
// Of the cells of a liberty file. Throws InputError where it cannot be read or describes no cell.
CostOf costs_of_liberty(const std::string& file);

// The least target that has room for what another's netlist uses, or null. DSPs have no place on a device
// without them, as what multipliers made of LUTs take is not known before.
const Target* nearest_that_holds(const Counts& used, const Target& except);

}  // namespace cuboct::synth
