// SPDX-License-Identifier: MIT
// What tools print, read from short pieces of it; names, harness, resources.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "model/base/error.h"
#include "model/base/process.h"
#include "synth/elaborate.h"
#include "synth/netlist.h"
#include "synth/report.h"
#include "synth/timing.h"
#include "synth/tool.h"

namespace cuboct::synth {
namespace {

class Parse : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_.path(name)) << text;
    return scratch_.path(name);
  }
  template <class F>
  std::string refusal(F&& f) const {
    try {
      f();
    } catch (const std::exception& error) {
      std::string text = error.what();
      if (const size_t at = text.find(scratch_.path("")); at != std::string::npos)
        text.erase(at, scratch_.path("").size());
      return text;
    }
    return "";
  }

 private:
  Scratch scratch_;
};

TEST_F(Parse, NextpnrReport) {
  const Placed placed = read_nextpnr_report(file("timing.json", R"({
    "critical_paths": [
      {"from": "posedge clk$SB_IO_IN_$glb_clk", "to": "posedge clk$SB_IO_IN_$glb_clk", "path": [
        {"delay": 1.39, "type": "clk-to-q", "from": {"cell": "a_LC"}, "to": {"cell": "a_LC", "port": "O"}},
        {"delay": 2.5, "type": "routing", "from": {"cell": "a_LC"}, "to": {"cell": "b_LC", "port": "I0"}}]},
      {"from": "<async>", "to": "posedge clk$SB_IO_IN_$glb_clk", "path": [
        {"delay": 99, "type": "routing", "from": {"cell": "x"}, "to": {"cell": "y", "port": "I0"}}]}],
    "fmax": {"clk$SB_IO_IN_$glb_clk": {"achieved": 47.09, "constraint": 48},
             "fast": {"achieved": 90, "constraint": 48}},
    "utilization": {"ICESTORM_LC": {"available": 5280, "used": 703},
                    "ICESTORM_DSP": {"available": 8, "used": 5}}})"));
  EXPECT_DOUBLE_EQ(placed.fmax, 47.09);
  EXPECT_EQ(placed.use.at("ICESTORM_LC").used, 703u);
  EXPECT_EQ(placed.use.at("ICESTORM_DSP").available, 8u);
  // The way in from a pin is no path of the clock.
  EXPECT_EQ(placed.critical, (std::vector<std::string>{"1.39 ns clk-to-q a_LC", "2.50 ns routing b_LC"}));
}

TEST_F(Parse, RefusesWhatIsNoReportOfNextpnr) {
  const std::string hint = "\n  hint: nextpnr writes it with --report FILE";
  EXPECT_EQ(refusal([&] { read_nextpnr_report(file("a", "{}")); }),
            "a: is no report of nextpnr: it has no 'fmax' and 'utilization'" + hint);
  EXPECT_EQ(refusal([&] { read_nextpnr_report(file("a", R"({"fmax": {}, "utilization": {}})")); }),
            "a: has no clock" + hint);
  EXPECT_EQ(refusal([&] { read_nextpnr_report(file("a", R"({"fmax": {"c": 3}, "utilization": {}})")); }),
            "a: is no report of nextpnr: an entry is of another kind" + hint);
  EXPECT_EQ(refusal([&] { read_nextpnr_report(file("a", "{]")); }), "a: is not JSON, at byte 2");
  EXPECT_EQ(refusal([&] { read_nextpnr_report(file("a", "{\"fmax\": 9e9999}")); }),
            "a: holds a number beyond those of doubles");
  EXPECT_EQ(refusal([&] { read_nextpnr_report(file("", "") + "none"); }), "none: cannot be read");
}

TEST_F(Parse, Utilisation) {
  const auto use = read_utilisation(
      "Info: Device utilisation:\n"
      "Info: \t         ICESTORM_LC:  6425/ 5280   121%\n"
      "Info: \t        ICESTORM_RAM:     6/   30    20%\n"
      "\n"
      "Info: Placed 3 cells based on constraints.\n");
  ASSERT_EQ(use.size(), 2u);
  EXPECT_EQ(use.at("ICESTORM_LC").used, 6425u);
  EXPECT_EQ(use.at("ICESTORM_LC").available, 5280u);
}

TEST_F(Parse, Icetime) {
  EXPECT_EQ(read_icetime("// Reading input .asc file..\n\nTotal number of logic levels: 9\n"
                         "Total path delay: 19.68 ns (50.81 MHz)\n"),
            50.81);
  EXPECT_EQ(read_icetime("// Reading input .asc file..\n"), std::nullopt);
}

TEST_F(Parse, OpenSta) {
  const auto found = read_sta(
      "          -8.59   data arrival time\n"
      "---------------------------------------------------------\n"
      "           1.25   slack (MET)\n"
      "\n"
      "Group                  Internal  Switching    Leakage      Total\n"
      "Sequential             2.69e-02   2.14e-03   1.82e-07   2.91e-02  43.8%\n"
      "Total                  5.25e-02   1.38e-02   1.68e-06   6.64e-02 100.0%\n");
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->slack, 1.25);
  EXPECT_DOUBLE_EQ(found->power, 6.64e-2);
  EXPECT_LT(read_sta("  -0.50   slack (VIOLATED)\nTotal 1 2 3 4 100.0%\n")->slack, 0);
  EXPECT_FALSE(read_sta("No paths found.\n"));
}

TEST_F(Parse, Depth) {
  EXPECT_EQ(read_depth("Longest topological path in a (length=2):\n    0: x\n"
                       "Longest topological path in top (length=58):\n"),
            58u);
  EXPECT_EQ(read_depth("nothing"), std::nullopt);
}

TEST_F(Parse, ComplaintOfALog) {
  EXPECT_EQ(complaint_of("Info: one\nERROR: No such command: foo\nEnd of script.\n"),
            "ERROR: No such command: foo");
  EXPECT_EQ(complaint_of("Info: one\nkilled\n\n"), "killed");
}

TEST_F(Parse, BaseNames) {
  EXPECT_EQ(base_name("cuboct_node"), "cuboct_node");
  EXPECT_EQ(base_name("$paramod$20d3a3fa280534516d5231e0c6e1621bd7469740\\cuboct_mult"), "cuboct_mult");
  EXPECT_EQ(base_name("$paramod\\cuboct_link_tx\\LinkBits=s32'00000000000000000000000001000000"),
            "cuboct_link_tx");
}

// top: two fifos of different depth, and a block that has one of the first kind.
Design small_design() {
  Design design;
  design.top = "cuboct_top";
  design.modules["cuboct_top"] = {
      "cuboct_top", {}, {{"u_a", "$paramod$a\\cuboct_fifo"}, {"u_block", "cuboct_block"}}};
  design.modules["cuboct_block"] = {
      "cuboct_block", {}, {{"u_f", "$paramod$a\\cuboct_fifo"}, {"u_g", "$paramod$b\\cuboct_fifo"}}};
  design.modules["$paramod$a\\cuboct_fifo"] = {"cuboct_fifo", {}, {}};
  design.modules["$paramod$b\\cuboct_fifo"] = {"cuboct_fifo", {}, {}};
  return design;
}

TEST_F(Parse, BlocksByName) {
  const Design design = small_design();
  EXPECT_EQ(module_of(design, "block"), "cuboct_block");
  EXPECT_EQ(module_of(design, "cuboct_block"), "cuboct_block");
  EXPECT_EQ(module_of(design, "fifo#1"), "$paramod$a\\cuboct_fifo");
  EXPECT_EQ(module_of(design, "fifo#2"), "$paramod$b\\cuboct_fifo");
  EXPECT_EQ(refusal([&] { module_of(design, "fifo"); }),
            "the block 'fifo' stands in the project with 2 sets of parameters\n"
            "  hint: --unit fifo#1 ... fifo#2 names one");
  EXPECT_EQ(refusal([&] { module_of(design, "fifo#3"); }), "--unit fifo#3: 'fifo' has 2 sets of parameters");
  EXPECT_EQ(refusal([&] { module_of(design, "blok"); }),
            "the project has no block 'blok'\n  hint: did you mean 'block'?");
  EXPECT_EQ(refusal([&] { module_of(design, "memories"); }),
            "the project has no block 'memories'\n  hint: there are block, fifo, top");
}

// Cells as yosys names them, each to the deepest instance of which it has the path; a kept module's below its
// own.
TEST_F(Parse, CellsGoToTheirBlocks) {
  const std::string netlist = file("netlist.json", R"({"modules": {
    "cuboct_top": {"attributes": {}, "cells": {
      "u_a.x_q_TRELLIS_FF_Q": {"type": "TRELLIS_FF"},
      "u_a.x_q_TRELLIS_FF_Q_1": {"type": "TRELLIS_FF"},
      "u_block.u_f.y_LUT4_Z": {"type": "LUT4"},
      "u_block.sum_CCU2C_S0": {"type": "CCU2C"},
      "u_block.u_gap_LUT4_Z": {"type": "LUT4"},
      "$flatten\\u_block.\\u_g.$procdff$12": {"type": "TRELLIS_FF"},
      "u_block.u_g.mem_q.0.0": {"type": "DP16KD"},
      "u_block.u_f.u_kept": {"type": "kept"},
      "start_LUT4_Z": {"type": "LUT4"}}},
    "kept": {"attributes": {}, "cells": {"p_q": {"type": "MULT18X18D"}}},
    "LUT4": {"attributes": {"blackbox": "1"}, "cells": {}}}})");
  const Block top = read_netlist(netlist, "cuboct_top", small_design(), "cuboct_top", costs_of(Family::ecp5));
  EXPECT_EQ(top.counts, (Counts{{5, 3, 1, 1}}));  // a carry cell is two LUTs
  ASSERT_EQ(top.children.size(), 2u);
  const Block& block = top.children[0];
  EXPECT_EQ(block.module, "cuboct_block");
  EXPECT_EQ(block.counts, (Counts{{4, 1, 1, 1}}));
  ASSERT_EQ(block.children.size(), 1u);  // both fifos in it are one row
  EXPECT_EQ(block.children[0].instances, 2u);
  EXPECT_EQ(block.children[0].counts, (Counts{{1, 1, 1, 1}}));
  EXPECT_EQ(top.children[1].counts, (Counts{{0, 2}}));
  EXPECT_EQ(refusal([&] {
              read_netlist(file("odd.json", R"({"modules": {"cuboct_top": {"attributes": {}, "cells":
                {"a": {"type": "FROB"}}}}})"),
                           "cuboct_top", small_design(), "cuboct_top", costs_of(Family::ecp5));
            }),
            "the netlist has a cell of an unknown kind, FROB");
}

TEST_F(Parse, CellsOfALibrary) {
  const CostOf cost =
      costs_of_liberty(file("a.lib",
                            "library(x) {\n cell (NAND2X1) {\n  area : 24;\n  pin(A) {}\n }\n"
                            " cell (\"DFFPOSX1\") {\n  area : 95.6;\n  ff (\"IQ\", \"IQN\") {}\n }\n}\n"));
  EXPECT_EQ((*cost("NAND2X1"))[Resource::area], 24u);
  EXPECT_EQ((*cost("NAND2X1"))[Resource::gates], 1u);
  EXPECT_EQ((*cost("DFFPOSX1"))[Resource::area], 96u);
  EXPECT_EQ((*cost("DFFPOSX1"))[Resource::ff], 1u);
  EXPECT_EQ((*cost("DFFPOSX1"))[Resource::gates], 0u);
  EXPECT_FALSE(cost("OR2X1"));
  EXPECT_EQ(refusal([&] { costs_of_liberty(file("b.lib", "no library")); }),
            "b.lib: describes no cell\n  hint: a liberty file is needed");
  for (const std::string area : {".", "e", "1e999", "-1", "1e13", "1-2"})
    EXPECT_EQ(refusal([&] {
                costs_of_liberty(file("c.lib", "library(x) {\n cell (A) {\n  area : " + area + ";\n }\n}\n"));
              }),
              "c.lib:3:10: '" + area + "' is no area of a cell");
}

TEST_F(Parse, Harness) {
  const Harness harness =
      make_harness("cuboct_x", {{"clk_i", true, 1}, {"a_i", true, 3}, {"b_i", true, 1}, {"y_o", false, 4}});
  EXPECT_EQ(harness.flip_flops, 4u + 4 + 2);  // 4 in, 4 out, 2 that fold these
  EXPECT_NE(harness.text.find("    .\\clk_i (clk_i),\n    .\\a_i (in_q[2:0]),\n    .\\b_i (in_q[3:3]),\n"
                              "    .\\y_o (out[3:0])\n"),
            std::string::npos)
      << harness.text;
  EXPECT_NE(harness.text.find("assign out[5:4] = 0;"), std::string::npos);
  EXPECT_EQ(refusal([&] {
              make_harness("cuboct_x", {{"a_i", true, 3}});
            }),
            "the block 'cuboct_x' has no output\n  hint: there is nothing to keep of it");
}

TEST_F(Parse, Fit) {
  Report report;
  report.target = "ecp5-25";
  report.holds = target_of("ecp5-25").holds;
  report.block.counts = {{1000, 500, 5, 2}};
  EXPECT_EQ(fit_of(report)->units, 4u);  // 75 % of 28 DSPs is 21
  EXPECT_EQ(fit_of(report)->limit, Resource::dsp);
  report.block.counts = {{1000, 500, 0, 2}};
  EXPECT_EQ(fit_of(report)->units, 24u);
  EXPECT_EQ(fit_of(report)->limit, Resource::lut);
  report.target = "up5k";
  report.holds = target_of("up5k").holds;
  report.harness = 100;
  report.pack({{"ICESTORM_LC", {2000, 5280}}});
  EXPECT_EQ(fit_of(report)->units, 2u);
  EXPECT_EQ(fit_of(report)->limit, Resource::cell);
}

TEST_F(Parse, WhatDoesNotFitHasRoomElsewhere) {
  Report report;
  report.target = "ecp5-25";
  report.unit = "pipe";
  report.used = {{30000, 500, 5, 2}};
  EXPECT_EQ(elsewhere(report), "xc7 has room for what it takes here");
  report.unit = "node";
  EXPECT_EQ(
      elsewhere(report),
      "xc7 has room for what it takes here; cuboct emit SCENE --fit ecp5-25 looks for a machine that fits");
  report.unit = "board";
  report.used = {{30000, 500, 500, 2}};
  EXPECT_EQ(elsewhere(report),
            "no target that is known has room for it; cuboct emit SCENE --fit ecp5-25 looks for a machine "
            "that fits");
}

// A shell (node around core) is one row; blocks without a cell are none; a block alone takes no steps.
TEST_F(Parse, Table) {
  Report report;
  report.plan = "0123456789abcdef";
  report.target = "ecp5-25";
  report.device = "LFE5U-25F";
  report.unit = "node";
  report.cycles = {200, 160, 170, 50};
  report.holds = target_of("ecp5-25").holds;
  const Block pipe{"cuboct_pipe", 2, {{700, 600, 6, 1}}, {}}, wires{"cuboct_resize", 4, {}, {}};
  const Block core{"cuboct_node_core", 1, {{1000, 900, 6, 3}}, {pipe, wires}};
  report.block = {"cuboct_node", 1, core.counts, {core}};
  report.depth = 31;
  const std::string head =
      "node of plan 0123456789abcdef on ecp5-25 (LFE5U-25F)\n"
      "\n"
      "block                                  x      LUT       FF      DSP     BRAM\n"
      "node                                   1     1000      900        6        3\n"
      "  pipe                                 2      700      600        6        1\n"
      "device holds                                24288    24288       28       56\n"
      "\n"
      "fit the device         3 of node, limited by DSP (planned to 75 %)\n"
      "cycles per step        160.0, the mean of the first 50 steps, counted; the most 170\n"
      "longest path           31 cells between registers\n";
  EXPECT_EQ(print_table(report), head + "Fmax                   not known: not placed\n");
  report.estimate = {
      8.33, 5.5, 0.2, {"2.00 ns wire", "6.33 ns LUT4 u_x.y"}, {" 8.33 ns u_x"}, {{"u_x", "u_z", 8.33}}};
  EXPECT_EQ(print_table(report),
            head +
                "clock, estimated       120.0 MHz before placement, to 20 %: 8.33 ns, 5.50 of them wires\n"
                "                        8.33 ns u_x\n"
                "Fmax                   not known: not placed\n");
  // A placed clock stands beside it, with how far it missed.
  report.take({125, {}, {}}, "nextpnr-ecp5, seed 1");
  EXPECT_NE(print_table(report).find("                        8.33 ns u_x\n"
                                     "estimate's error       -4.0 %\n"
                                     "Fmax                   125.00 MHz"),
            std::string::npos)
      << print_table(report);
  const Report estimated = read_report(file("report.json", to_json(report).dump()));
  EXPECT_EQ(print_table(estimated), print_table(report));
  EXPECT_EQ(to_json(estimated).dump(), to_json(report).dump());
  report.estimate.reset();
  report.take({125, {}, {}}, "nextpnr-ecp5, seed 1");
  EXPECT_EQ(print_table(report), head +
                                     "Fmax                   125.00 MHz (nextpnr-ecp5, seed 1)\n"
                                     "steps per second       7.812e+05 at Fmax\n");
  const Report again = read_report(file("report.json", to_json(report).dump()));
  EXPECT_EQ(print_table(again), print_table(report));
  report.unit = "pipe";
  EXPECT_EQ(print_table(report).find("steps per second"), std::string::npos);
  EXPECT_EQ(print_table(report).find("cycles per step"), std::string::npos);
  report.unit = "node";
  report.nodes = 4;
  EXPECT_NE(print_table(report).find("limited by DSP (planned to 75 %)\n"
                                     "the scene's nodes      4: cuboct emit SCENE --fit ecp5-25 looks for a "
                                     "machine that fits\n"),
            std::string::npos);
  report.nodes = 3;
  EXPECT_EQ(print_table(report).find("--fit"), std::string::npos);
  report.cycles.steps = 0;
  EXPECT_NE(print_table(report).find(
                "cycles per step        200, expected of the busiest node: no run counted them\n"),
            std::string::npos);
  EXPECT_NE(print_table(report).find("steps per second       6.25e+05 at Fmax\n"), std::string::npos);
}

TEST_F(Parse, NearestTargetThatHolds) {
  EXPECT_EQ(nearest_that_holds({{6000, 100, 0, 3}}, target_of("up5k"))->name, "hx8k");
  EXPECT_EQ(nearest_that_holds({{6000, 100, 1, 3}}, target_of("up5k"))->name, "ecp5-25");
  EXPECT_EQ(nearest_that_holds({{6000, 100, 22, 3}}, target_of("up5k"))->name, "xc7");
  EXPECT_EQ(nearest_that_holds({{70000, 100, 22, 3}}, target_of("up5k"))->name, "ecp5-85");
  EXPECT_EQ(nearest_that_holds({{90000, 100, 22, 3}}, target_of("up5k")), nullptr);
}

}  // namespace
}  // namespace cuboct::synth
