// SPDX-License-Identifier: MIT
// The clock before placement: rules of wires against the paths that they come from, and OpenSTA's longest
// path of small netlists against sums by hand.
#include "synth/estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "model/base/output.h"
#include "model/base/process.h"
#include "synth/tool.h"
#include "tests/support/refused_with.h"

namespace cuboct::synth {
namespace {

const Delays& ecp5() { return *delays_of(target_of("ecp5-85")); }

TEST(Estimate, Patterns) {
  EXPECT_TRUE(matches("A#|B#", "B17"));
  EXPECT_FALSE(matches("A#|B#", "B"));
  EXPECT_FALSE(matches("A#", "A1x"));
  EXPECT_TRUE(matches("SB_DFF*", "SB_DFF"));
  EXPECT_TRUE(matches("SB_DFF*", "SB_DFFESR"));
  EXPECT_FALSE(matches("S0", "S1"));
}

TEST(Estimate, Blocks) {
  EXPECT_EQ(block_of("u_unit.u_core.gen_pipe[0].u_pipe.gen_d.x_q_TRELLIS_FF_Q"), "u_core.gen_pipe[0].u_pipe");
  EXPECT_EQ(block_of("$flatten\\u_unit.\\u_core.\\u_f.$procdff$12"), "u_core.u_f");
  EXPECT_EQ(block_of("u_unit.start_LUT4_Z"), ".");
  EXPECT_EQ(block_of("in_q_TRELLIS_FF_Q_3"), "harness");
}

// Wires on published critical paths, which no constant is fitted to: their mean is what a net of two sinks
// has, and each path's sum is met to a fifth.
TEST(Estimate, Ecp5WiresAreThoseOfPublishedPaths) {
  std::ifstream in(CUBOCT_SOURCE_DIR "/synth/ecp5_paths.tsv");
  struct Known {
    double cells = 0, wires = 0;
    int count = 0;
  };
  std::map<std::string, Known> paths;
  double sum = 0;
  int wires = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#') || line.starts_with("path\t")) continue;
    std::istringstream row(line);
    std::string path, from, to;
    double columns = 0, rows = 0, ns = 0;
    ASSERT_TRUE(row >> path >> from >> to >> columns >> rows >> ns) << line;
    if (from == "cells") {
      paths[path].cells = ns;
      continue;
    }
    paths[path].wires += ns;
    ++paths[path].count;
    sum += ns;
    ++wires;
  }
  ASSERT_GT(wires, 20);
  const Wires& w = ecp5().wires;
  const double two = w.share * (w.near + w.doubling);
  EXPECT_NEAR(sum / wires, two, 0.03 * two);
  for (const auto& [path, known] : paths) {
    const double whole = known.cells + known.wires;
    EXPECT_GT(known.cells, 0) << path;
    EXPECT_NEAR(known.cells + known.count * two, whole, 0.2 * whole) << path;
  }
}

TEST(Estimate, LinksThatAreNoWires) {
  const Wires& w = ecp5().wires;
  const auto ns = [&](const char* from, const char* out, const char* to, const char* in, size_t sinks,
                      bool& taken) { return wire_delay(w, from, out, to, in, sinks, taken); };
  bool taken = false;
  EXPECT_EQ(ns("CCU2C", "COUT", "CCU2C", "CIN", 1, taken), 0);
  EXPECT_EQ(ns("LUT4", "Z", "PFUMX", "BLUT", 1, taken), 0);
  EXPECT_EQ(ns("PFUMX", "Z", "L6MUX21", "D1", 1, taken), 0);
  EXPECT_DOUBLE_EQ(ns("LUT4", "Z", "LUT4", "A", 8, taken), w.share * (w.near + 3 * w.doubling));
  // No longer on a wider net; bits of a memory lie farther apart, its enable does not.
  EXPECT_DOUBLE_EQ(ns("LUT4", "Z", "LUT4", "A", 800, taken), w.share * (w.near + 3 * w.doubling));
  EXPECT_DOUBLE_EQ(ns("LUT4", "Z", "TRELLIS_DPR16X4", "DI_2", 4, taken), w.share * (w.near + 2 * w.spread));
  EXPECT_DOUBLE_EQ(ns("LUT4", "Z", "TRELLIS_DPR16X4", "WRE", 4, taken), w.share * (w.near + 2 * w.doubling));
  EXPECT_DOUBLE_EQ(ns("TRELLIS_FF", "Q", "MULT18X18D", "A3", 1, taken), w.share * (w.near + w.far));
  EXPECT_DOUBLE_EQ(ns("DP16KD", "DOB3", "LUT4", "A", 1, taken), w.share * (w.near + w.far));
  EXPECT_DOUBLE_EQ(ns("LUT4", "Z", "DP16KD", "ADA3", 1, taken), w.share * w.near);
  // A chain's end reaches other pins through a cell more.
  EXPECT_DOUBLE_EQ(ns("CCU2C", "COUT", "LUT4", "D", 1, taken), 0.443 + w.share * w.near);
  // One register shares the LUT's slice, a second does not.
  EXPECT_FALSE(taken);
  EXPECT_LT(ns("LUT4", "Z", "TRELLIS_FF", "DI", 2, taken), 0.2);
  EXPECT_TRUE(taken);
  EXPECT_DOUBLE_EQ(ns("LUT4", "Z", "TRELLIS_FF", "DI", 2, taken), w.share * (w.near + w.spread));
  // iCE40 packs a LUT with the register that is its only reader.
  const Wires& ice = delays_of(target_of("hx8k"))->wires;
  bool none = false;
  EXPECT_EQ(wire_delay(ice, "SB_LUT4", "O", "SB_DFFE", "D", 1, none), 0);
  EXPECT_GT(wire_delay(ice, "SB_LUT4", "O", "SB_DFFE", "D", 2, none), 1);
}

// u_unit: a (register) -> LUT -> two carries -> LUT -> b (register); a -> multiplier -> c, in a module of its
// own. `harness` of the file's module: pins.
constexpr const char* kNetlist = R"({"modules": {
  "cuboct_mult": {"attributes": {}, "ports": {"a_i": {"direction": "input", "bits": [2]},
      "clk_i": {"direction": "input", "bits": [3]}, "p_o": {"direction": "output", "bits": [5]}}, "cells": {
    "m": {"type": "MULT18X18D", "parameters": {}, "port_directions": {"A0": "input", "B0": "input", "P0": "output"},
          "connections": {"A0": [2], "B0": ["1"], "P0": [4]}},
    "p_q": {"type": "TRELLIS_FF", "parameters": {}, "port_directions": {"CLK": "input", "DI": "input", "Q": "output"},
            "connections": {"CLK": [3], "DI": [4], "Q": [5]}}}},
  "top": {"attributes": {}, "ports": {"clk_i": {"direction": "input", "bits": [2]}}, "cells": {
    "u_unit.u_a.a_q": {"type": "TRELLIS_FF", "parameters": {},
      "port_directions": {"CLK": "input", "DI": "input", "Q": "output"},
      "connections": {"CLK": [2], "DI": [20], "Q": [10]}},
    "u_unit.u_a.lut": {"type": "LUT4", "parameters": {},
      "port_directions": {"A": "input", "B": "input", "Z": "output"},
      "connections": {"A": [10], "B": ["0"], "Z": [11]}},
    "u_unit.u_b.c1": {"type": "CCU2C", "parameters": {},
      "port_directions": {"A0": "input", "COUT": "output"}, "connections": {"A0": [11], "COUT": [12]}},
    "u_unit.u_b.c2": {"type": "CCU2C", "parameters": {},
      "port_directions": {"CIN": "input", "S1": "output"}, "connections": {"CIN": [12], "S1": [13]}},
    "u_unit.u_b.lut": {"type": "LUT4", "parameters": {},
      "port_directions": {"D": "input", "Z": "output"}, "connections": {"D": [13], "Z": [14]}},
    "u_unit.u_b.b_q": {"type": "TRELLIS_FF", "parameters": {},
      "port_directions": {"CLK": "input", "DI": "input", "Q": "output"},
      "connections": {"CLK": [2], "DI": [14], "Q": [20]}},
    "u_unit.u_mult": {"type": "cuboct_mult", "parameters": {},
      "port_directions": {"a_i": "input", "clk_i": "input", "p_o": "output"},
      "connections": {"a_i": [10], "clk_i": [2], "p_o": [15]}}}}}})";

std::vector<Path> paths_of(const std::string& netlist, const Delays& delays) {
  const Scratch scratch;
  std::ofstream(scratch.path("netlist.json")) << netlist;
  const Timer timer(scratch.path("netlist.json"), "top", delays);
  const Runner tools(scratch.path(""), [](const std::string&, int) {});
  tools.write("cells.lib", timer.library());
  tools.write("timed.v", timer.netlist());
  tools.write("wires.sdf", timer.wires());
  tools.write("sta.tcl", Timer::script(scratch.path(""), timer.clocks(), 10));
  tools.run("sta", "sta", "sta", {"-no_splash", "-exit", tools.path("sta.tcl")});
  return timer.read(read_text(tools.path("sta.log")));
}

TEST(Estimate, LongestPathIsTheSumOfItsCellsAndWires) {
  const std::vector<Path> paths = paths_of(kNetlist, ecp5());
  ASSERT_EQ(paths.size(), 3u);  // to a, b and the multiplier's register
  const Wires& w = ecp5().wires;
  const double two = w.near + w.doubling;  // a's net has two sinks; times the share
  // Register, wire, LUT, wire, into a chain, through it, wire, LUT, into its register.
  const double through = 0.525 + 0.236 + 0.447 + 0 + 0.474 + 0.236 + 0.130 + w.share * (two + 2 * w.near);
  const double product = 0.525 + 3.927 + w.share * (two + w.far + w.near + w.far);
  EXPECT_NEAR(paths[0].total, product, 0.005);
  EXPECT_NEAR(paths[0].wires(), w.share * (two + w.near + 2 * w.far), 0.003);
  EXPECT_NEAR(paths[1].total, through, 0.005);
  std::vector<std::string> cells;
  for (const Hop& hop : paths[1].hops) cells.push_back(hop.cell);
  EXPECT_EQ(cells, (std::vector<std::string>{"u_unit.u_a.a_q", "u_unit.u_a.lut", "u_unit.u_b.c1",
                                             "u_unit.u_b.c2", "u_unit.u_b.lut", "u_unit.u_b.b_q"}));
  const auto e = summary(paths, ecp5());
  ASSERT_TRUE(e);
  EXPECT_DOUBLE_EQ(e->ns, paths[0].total);
  EXPECT_EQ(e->blocks.front().substr(9), "u_a");
  EXPECT_EQ(e->blocks.back().substr(9), "u_mult");
  ASSERT_EQ(e->ends.size(), 3u);
  EXPECT_EQ(e->ends[1].from, "u_a");
  EXPECT_EQ(e->ends[1].to, "u_b");
  EXPECT_FALSE(summary({}, ecp5()));
}

TEST(Estimate, RefusesACellWithoutDelays) {
  std::string odd = kNetlist;
  odd.replace(odd.find("MULT18X18D"), 10, "ALU54B");
  EXPECT_EQ(refused_with<std::runtime_error>([&] { paths_of(odd, ecp5()); }),
            "the netlist has a cell whose delays are not known, ALU54B");
}

}  // namespace
}  // namespace cuboct::synth
