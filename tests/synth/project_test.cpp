// SPDX-License-Identifier: MIT
// What a request must have: a project, a target, a tool, a report to add to.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "hw/plan/setup.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/error.h"
#include "model/base/process.h"
#include "synth/elaborate.h"
#include "synth/flow.h"
#include "synth/project.h"
#include "synth/script.h"
#include "synth/tool.h"
#include "tests/support/refused_with.h"

namespace cuboct::synth {
namespace {

namespace fs = std::filesystem;

class Refuse : public ::testing::Test {
 protected:
  // Emits the small sheet.
  void emit(const std::optional<CountedCycles>& counted = {}) {
    const std::string here = CUBOCT_SOURCE_DIR "/tests/synth/";
    const cuboct::Setup setup = make_setup(read_scene(here + "sheet.toml"), read_arch(here + "narrow.toml"));
    emit_rtl(setup.plan, setup.initial, dir_, {.counted = counted});
    plan_ = setup.plan;
  }
  std::string refusal(const Request& request) const {
    try {
      synthesise(request);
    } catch (const InputError& error) {
      std::string text = error.what();
      for (size_t at; (at = text.find(dir_)) != std::string::npos;) text.replace(at, dir_.size(), "DIR");
      return text;
    }
    return "";
  }
  Request request(const std::string& target = "up5k") const {
    Request r;
    r.directory = dir_;
    r.target = target;
    return r;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ + "/" + name) << text;
  }

  Scratch scratch_;
  std::string dir_ = scratch_.path("project");
  Plan plan_;
};

// A project of a stranger: names of files and modules go into scripts of yosys, Tcl and a shell.
TEST_F(Refuse, NamesThatAScriptWouldRun) {
  emit();
  write("a\";!touch loot.sv", "module x; endmodule\n");
  write(
      "project.json",
      R"({"plan": "x", "nodes": 1, "particles": 1, "arch": {"capacity": 1}, "cycles_per_step": {"expected": 1},
    "files": ["a\";!touch loot.sv"]})");
  EXPECT_EQ(refusal(request()).substr(0, 60),
            "yosys cannot be given a file called 'DIR/a\";!touch loot.sv'\n");
  const std::string design = scratch_.path("elaborated.json");
  const auto with_module = [&](const std::string& name) {
    std::ofstream(design) << R"({"modules": {")" << name
                          << R"(": {"attributes": {"top": "1"}, "ports": {}, "cells": {}}}})";
    return refused_with([&] { read_design(design); });
  };
  EXPECT_EQ(with_module("cuboct_node"), "accepted");
  EXPECT_EQ(with_module("$paramod$1f\\\\cuboct_fifo"), "accepted");
  for (const char* name :
       {"x;!touch loot", "x\\n!touch loot", "$(touch loot)", "`touch loot`", "x\\u0000y", "$paramod\\\\x y"})
    EXPECT_NE(with_module(name).find("the project has a module called"), std::string::npos) << name;
}

TEST_F(Refuse, ScriptsHoldPathsAsOneWord) {
  EXPECT_NE(sta_script("a} ; exec touch x", "n", "top", 1, 0.1)
                .find("read_liberty a\\}\\ \\;\\ exec\\ touch\\ x\n"),
            std::string::npos);
  EXPECT_NE(place_script(target_of("ecp5-25"), "$(touch x)", 1, 1, "").find("--top '$(touch x)' "),
            std::string::npos);
}

TEST_F(Refuse, TellsOfTheProject) {
  emit();
  const Project project = read_project(dir_);
  EXPECT_EQ(project.nodes, plan_.lattice.size());
  EXPECT_EQ(project.particles, plan_.particles);
  EXPECT_EQ(project.plan.size(), 16u);
  EXPECT_EQ(std::stoull(project.plan, nullptr, 16), plan_.hash);
  EXPECT_EQ(project.capacity, 3);
  EXPECT_GT(project.cycles.expected.value_or(0), 20u);
  EXPECT_EQ(project.cycles.steps, 0u);
  EXPECT_EQ(project.files[0], "rtl/cuboct_pkg.sv");
  std::ifstream list(dir_ + "/files.f");
  std::vector<std::string> files;
  for (std::string line; std::getline(list, line);) files.push_back(line);
  EXPECT_EQ(project.files, files);
}

TEST_F(Refuse, AProjectOfAnotherVersion) {
  emit();
  std::ifstream in(dir_ + "/project.json");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string version = "\"version\": 1,";
  const size_t at = text.find(version);
  ASSERT_NE(at, std::string::npos);
  std::string other = text;
  write("project.json", other.replace(at, version.size(), "\"version\": 2,"));
  EXPECT_EQ(
      refused_with([&] { read_project(dir_); }),
      dir_ +
          "/project.json: a project of version 2: this cuboct reads version 1\n  hint: emit it again, or "
          "take the cuboct that wrote it");
  // Those of before there were versions.
  other = text;
  write("project.json", other.erase(at, version.size()));
  EXPECT_EQ(read_project(dir_).plan.size(), 16u);
}

// What was counted is what clocks are divided by; what is expected is for projects without it.
TEST_F(Refuse, CountedCyclesAreThoseOfTheProject) {
  emit(CountedCycles{4, 250, 64});
  const ProjectCycles cycles = read_project(dir_).cycles;
  EXPECT_EQ(cycles.steps, 4u);
  EXPECT_EQ(cycles.mean, 62.5);
  EXPECT_EQ(cycles.most, 64u);
  EXPECT_EQ(cycles.best(), 62.5);
  EXPECT_EQ((ProjectCycles{.expected = 70}.best()), 70);
}

// Nothing is expected of a rule of text, and a run that ends in its first step counts nothing.
TEST_F(Refuse, CyclesMayBeUnknown) {
  fs::create_directory(dir_);
  const auto cycles = [&](const char* told) {
    write("project.json", std::string(R"({"plan": "x", "nodes": 1, "particles": 1, "arch": {"capacity": 4},
                                          "cycles_per_step": )") +
                              told + R"(, "files": []})");
    return read_project(dir_).cycles;
  };
  EXPECT_EQ(cycles(R"({"counted": {"mean": 9.5, "most": 10, "steps": 2}})").best(), 9.5);
  Report report;
  report.plan = "x", report.target = "ecp5-25", report.unit = "node", report.nodes = 1, report.particles = 1;
  report.fmax = 50, report.fmax_from = "nextpnr";
  report.cycles = cycles("{}");
  EXPECT_EQ(report.cycles.best(), std::nullopt);
  const std::string table = print_table(report), json = report_json(report);
  EXPECT_NE(table.find("not known: no run counted them"), std::string::npos) << table;
  EXPECT_EQ(table.find("steps per second"), std::string::npos) << table;
  EXPECT_EQ(json.find("steps_per_second"), std::string::npos) << json;
  report.cycles = cycles(R"({"counted": {"mean": 20, "most": 25, "steps": 2}})");
  EXPECT_NE(print_table(report).find("2.5e+06 at Fmax"), std::string::npos) << print_table(report);
}

TEST_F(Refuse, WhatIsNoProject) {
  const std::string hint = "\n  hint: cuboct emit SCENE --out DIR makes a project";
  EXPECT_EQ(refusal(request()), "DIR: no such directory" + hint);
  fs::create_directory(dir_);
  EXPECT_EQ(refusal(request()), "DIR: is no project of cuboct emit: it has no project.json" + hint);
  write("project.json", "{\"plan\":");
  EXPECT_EQ(refusal(request()), "DIR/project.json: is not JSON, at byte 9" + hint);
  write("project.json", "{\"plan\": \"x\", \"nodes\": 9e9999}");
  EXPECT_EQ(refusal(request()), "DIR/project.json: holds a number beyond those of doubles" + hint);
  write("project.json", "{\"plan\": \"x\", \"nodes\": \"many\"}");
  EXPECT_EQ(refusal(request()), "DIR/project.json: no 'nodes' as cuboct emit writes it" + hint);
  write("project.json",
        R"({"plan": "x", "nodes": 1, "particles": 1, "arch": {"capacity": 4},
            "cycles_per_step": {"expected": 9},
            "files": ["rtl/a.sv"]})");
  EXPECT_EQ(refusal(request()),
            "DIR/project.json: names rtl/a.sv, which is not there\n  hint: emit the project again");
}

TEST_F(Refuse, UnknownTargets) {
  EXPECT_EQ(refusal(request("xc6")),
            "unknown target 'xc6'\n  hint: did you mean 'xc7'? there are up5k, hx8k, ecp5-25, ecp5-85, xc7 "
            "and asic");
  EXPECT_EQ(refusal(request("stratix")),
            "unknown target 'stratix'\n  hint: there are up5k, hx8k, ecp5-25, ecp5-85, xc7 and asic");
}

TEST_F(Refuse, ABoardThatIsNotThere) {
  emit();
  Request r = request();
  r.unit = "board";
  EXPECT_EQ(refusal(r), "DIR: has no board/\n  hint: cuboct emit SCENE --out DIR --board BOARD writes one");
  EXPECT_FALSE(fs::exists(dir_ + "/synth"));
}

TEST_F(Refuse, MissingToolsWithTheirPackages) {
  emit();
  const std::string path = std::getenv("PATH");
  setenv("PATH", scratch_.path("").c_str(), 1);
  const std::string yosys = refusal(request());
  // A yosys that is there and an OpenSTA that is not.
  std::ofstream(scratch_.path("yosys")) << "#!/bin/sh\n";
  fs::permissions(scratch_.path("yosys"), fs::perms::owner_all);
  const std::string sta = refusal(request("asic"));
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(yosys, "yosys is not in PATH\n  hint: apt-get install yosys");
  EXPECT_EQ(sta, "sta is not in PATH\n  hint: apt-get install opensta");
  EXPECT_FALSE(fs::exists(dir_ + "/synth"));
}

TEST_F(Refuse, AToolWithoutItsData) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", (scratch_.path("") + ":" + path).c_str(), 1);
  std::ofstream(scratch_.path("icetime"))
      << "#!/bin/sh\necho \"Can't find chipdb file for device 5k\" >&2\nexit 1\n";
  fs::permissions(scratch_.path("icetime"), fs::perms::owner_all);
  std::string told;
  try {
    Runner(scratch_.path(""), [](const std::string&, int) {}).run("", "icetime", "icetime", {"-d", "up5k"});
  } catch (const ToolFailed& error) {
    told = error.what();
  }
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(told,
            "icetime failed: Can't find chipdb file for device 5k; apt-get install fpga-icestorm-chipdb");
}

TEST_F(Refuse, TimingWithoutWhatItIsOf) {
  emit();
  write("timing.json", R"({"fmax": {"clk": {"achieved": 99.0}}, "utilization": {}})");
  Request r = request();
  r.timing = dir_ + "/timing.json";
  EXPECT_EQ(refusal(r), "--timing is for ecp5-25 and ecp5-85: up5k is placed here or not at all");
  r.target = "ecp5-85";
  EXPECT_EQ(refusal(r),
            "DIR/synth/ecp5-85/node: holds no synthesis yet\n  hint: run the command without --timing first");
  fs::create_directories(dir_ + "/synth/ecp5-85/node");
  write("synth/ecp5-85/node/report.json", R"({"plan": "0123"})");
  EXPECT_EQ(refusal(r), "DIR/synth/ecp5-85/node/report.json: is no report of cuboct synth");
  Report other;
  other.plan = "0123";
  other.target = "ecp5-85";
  write("synth/ecp5-85/node/report.json", to_json(other).dump());
  EXPECT_EQ(refusal(r), "DIR/synth/ecp5-85/node: is of plan 0123, the project of " + read_project(dir_).plan +
                            "\n  hint: run the command without --timing first");
}

}  // namespace
}  // namespace cuboct::synth
