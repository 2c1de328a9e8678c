// SPDX-License-Identifier: MIT
// What `cuboct synth` found: stored as report.json, printed as a table.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "synth/netlist.h"
#include "synth/project.h"
#include "synth/target.h"
#include "synth/timing.h"

namespace cuboct::synth {

// Of standard cells.
struct Silicon {
  std::string library;   // name of the liberty file
  double area = 0;       // um^2
  double delay = 0;      // ns, of the longest path
  double power = 0;      // W at `frequency`
  double activity = 0;   // assumed: changes of each net per clock
  double frequency = 0;  // MHz that the power is of
};

// Of a netlist before it is placed: estimate.h.
struct Estimate {
  // The slowest of the paths that end in registers of one block.
  struct End {
    std::string from, to;  // blocks, by the names of their instances
    double ns = 0;
  };
  double ns = 0, wires = 0;         // of the longest path, and of its wires
  double error = 0;                 // largest share by which such an estimate is known to have missed
  std::vector<std::string> path;    // "1.50 ns wire", "0.24 ns LUT4 u_core.u_x.y_LUT4_Z", ...
  std::vector<std::string> blocks;  // those that it goes through: "5.83 ns u_core.u_x"
  std::vector<End> ends;            // the longest first; of the paths that were looked at

  double mhz() const { return 1000 / ns; }
};

struct Report {
  std::string plan, target, device, unit;
  uint64_t nodes = 0, particles = 0;
  ProjectCycles cycles;
  Block block;                    // the unit's
  Counts used;                    // by unit and harness
  Counts holds;                   // by the device; zeros for asic
  std::optional<uint64_t> cells;  // logic cells of the unit as packed, without the harness (ice40)
  uint64_t harness = 0;           // flip-flops of the harness: on ice40, its logic cells
  std::optional<uint64_t> depth;  // cells of the longest path between registers
  std::optional<Estimate> estimate;
  std::optional<double> fmax;     // MHz, as placed and routed
  std::string fmax_from;          // "nextpnr-ice40, seed 1"
  std::optional<double> icetime;  // MHz, by icetime
  std::vector<std::string> critical;
  std::optional<Silicon> silicon;
  std::vector<std::string> tools;  // versions
  std::vector<std::string> files;  // of the report's directory, in the order of names

  void pack(const std::map<std::string, Use>& use);  // sets `cells`
  void take(const Placed& placed, const std::string& from);
};

// How many units of this kind fit, and the resource that ends it; of nothing that is limited: none.
struct Fit {
  uint64_t units = 0;
  Resource limit = Resource::lut;
};
std::optional<Fit> fit_of(const Report& report);

// Where what does not fit its target has room: a hint.
std::string elsewhere(const Report& report);

std::string print_table(const Report& report);
nlohmann::ordered_json to_json(const Report& report);
// As text that a terminal can show too, whatever names a project has.
std::string report_json(const Report& report);
// Reads back what to_json gave. Throws InputError where the file is another's.
Report read_report(const std::string& file);

}  // namespace cuboct::synth
