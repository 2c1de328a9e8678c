// SPDX-License-Identifier: MIT
// What pipelines are made of, read off their schedules, beside what yosys makes of them for an ECP5 and the
// clock of its netlist as `cuboct synth` estimates it: rows of a table, with tabs.
// usage: pipeline_report rules|laws DIR [NAME...]   DIR is empty or new
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "hw/pipeline/resources.h"
#include "hw/plan/setup.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/output.h"
#include "model/contract/pair_program.h"
#include "model/program/integer_program.h"
#include "synth/flow.h"
#include "tests/pipeline/pipelines.h"

namespace {

using namespace cuboct;
namespace fs = std::filesystem;

const std::string kRoot = CUBOCT_SOURCE_DIR;

// As text for a table: LUT, FF, DSP, BRAM, MHz.
std::string synthesised(const std::string& dir, const std::string& unit) {
  synth::Request request;
  request.directory = dir, request.target = "ecp5-85", request.unit = unit, request.place = false;
  const synth::Report report = synth::synthesise(request);
  std::string text;
  for (const synth::Resource r :
       {synth::Resource::lut, synth::Resource::ff, synth::Resource::dsp, synth::Resource::bram})
    text += fmt::format("{}\t", report.block.counts[r]);
  return text + (report.estimate ? fmt::format("{:.0f}", report.estimate->mhz()) : "-");
}

// A project of one module, which stands for the node.
void write_project(const std::string& dir, const test::Pipeline& p) {
  std::vector<std::string> files;
  const auto add = [&](const std::string& name, const std::string& text) {
    fs::create_directories(fs::path(dir) / "rtl");
    files.push_back("rtl/" + name + ".sv");
    write_text((fs::path(dir) / files.back()).string(), text);
  };
  for (const char* name : {"lib/arithmetic/cuboct_mult", "pipeline/cuboct_leading_zeros"})
    add(fs::path(name).filename(), read_text(kRoot + "/rtl/" + name + ".sv"));
  for (const auto& module : pipeline::print_pipeline("cuboct_node", p.graph, p.outputs, p.schedule))
    add(module.name, module.text);
  const nlohmann::json project = {
      {"plan", std::string(16, '0')},         {"nodes", 1},    {"particles", 1}, {"arch", {{"capacity", 1}}},
      {"cycles_per_step", {{"expected", 1}}}, {"files", files}};
  write_text((fs::path(dir) / "project.json").string(), project.dump());
}

void print_row(const std::string& dir, const std::string& name, const test::Pipeline& p) {
  const pipeline::Resources r = pipeline::resources_of(p.graph, p.schedule);
  write_project(dir + "/" + p.name, p);
  fmt::print("{}\t{}\t{}\t{}\t{}\t{}\t{:.1f}\t{}\n", name, r.cycles, r.products.size(), r.adder_bits,
             r.choice_bits, r.register_bits, static_cast<double>(r.rom_bits()) / 1024,
             synthesised(dir + "/" + p.name, "node"));
  std::fflush(stdout);
}

void print_head(const char* what) {
  fmt::print(
      "{}\tcycles\tproducts\tadder bits\tchoice bits\tregister bits\tROM, kbit\tLUT\tFF\tDSP\tBRAM\tMHz\n",
      what);
}

void print_rules(const std::string& dir, const std::vector<std::string>& names) {
  print_head("pipeline of");
  for (const std::string& name : names) {
    const Scene scene = read_scene(kRoot + "/scenes/rules/" + name + ".toml");
    const Plan plan = program_plan_of(scene, Arch{});
    const graph::FixedProgram& program = plan.program->program;
    for (const graph::Round& round : program.rounds) {
      const std::string at = fmt::format("{}, {}", name, round.name);
      print_row(dir, at + ": pair", test::pair_of(name + "_" + round.name, round));
      print_row(dir, at + ": finish", test::finish_of(name + "_" + round.name, program, round));
    }
  }
}

void print_laws(const std::string& dir, const std::vector<std::string>& names) {
  print_head("pair of");
  for (const std::string& name : names) {
    const Setup setup = make_setup(read_scene(kRoot + "/scenes/" + name + ".toml"), Arch{});
    const graph::FixedProgram program = pair_program(setup.plan.rule, setup.plan.arch.capacity);
    print_row(dir, name + ", as a program", test::pair_of(name, program.rounds[0]));
    emit_rtl(setup.plan, setup.initial, dir + "/" + name, {.vector_steps = 1});
    fmt::print("{}, `cuboct_pipe`\t{}\t\t\t\t\t\t{}\n", name, setup.plan.latency.pipe,
               synthesised(dir + "/" + name, "pipe"));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string kind = argc > 2 ? argv[1] : "";
  if (kind != "rules" && kind != "laws")
    return std::fputs("usage: pipeline_report rules|laws DIR [NAME...]\n", stderr), 2;
  std::vector<std::string> names(argv + 3, argv + argc);
  if (names.empty())
    names = kind == "rules" ? std::vector<std::string>{"heat", "copper", "glass"}
                            : std::vector<std::string>{"undamped_block", "lj_block", "coupon"};
  try {
    kind == "rules" ? print_rules(argv[2], names) : print_laws(argv[2], names);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pipeline_report: %s\n", error.what());
    return 1;
  }
}
