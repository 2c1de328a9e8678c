// SPDX-License-Identifier: MIT
// Printed pipelines, Verilated, beside the interpreter: values, faults and cycles.
#include "hw/pipeline/print.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "hw/pipeline/layout.h"
#include "hw/pipeline/schedule_check.h"
#include "model/base/output.h"
#include "model/contract/pair_program.h"
#include "tests/graph/random_graph.h"
#include "tests/graph/random_rule.h"
#include "tests/pipeline/pipelines.h"
#include "tests/pipeline/rules.h"

namespace cuboct::test {
namespace {

using graph::Op;
using pipeline::Kind;

Compared expect_equal(const std::vector<Pipeline>& pipelines, size_t sets) {
  std::vector<Difference> differences;
  const Compared compared = compare(pipelines, sets, 1, differences);
  for (const Difference& difference : differences) EXPECT_EQ(difference.what, "");
  EXPECT_GE(compared.sets, sets * pipelines.size());
  return compared;
}

void expect_all_ops(const Compared& compared, uint64_t values) {
  for (int op = static_cast<int>(Op::input); op <= static_cast<int>(Op::noise); ++op) {
    const auto found = compared.by_op.find(static_cast<Op>(op));
    EXPECT_GE(found == compared.by_op.end() ? 0 : found->second, values) << to_string(static_cast<Op>(op));
  }
}

void add_random(std::vector<Pipeline>& all, uint64_t first, int count, int steps) {
  for (uint64_t seed = first; seed < first + static_cast<uint64_t>(count); ++seed) {
    Drawn drawn = random_graph(seed, steps);
    all.push_back(all_of("random_" + std::to_string(seed), std::move(drawn.graph), drawn.when));
  }
}

void add_program(std::vector<Pipeline>& all, const std::string& name, const graph::FixedProgram& program) {
  for (const graph::Round& round : program.rounds) {
    all.push_back(pair_of(name + "_" + round.name, round));
    all.push_back(finish_of(name + "_" + round.name, program, round));
  }
}

// Random graphs over all operations, and a rule's pairs and finishes: one model, as its compiler takes
// longest.
TEST(PrintedPipeline, IsTheInterpreter) {
  std::vector<Pipeline> all;
  add_random(all, 1, 3, 24);
  graph::Builder wires;  // no cycle at all
  wires.floor(wires.input(graph::Source::own_field, 0, 0, {-100, 90}), 3);
  all.push_back(all_of("wires", wires.take(), -1));
  EXPECT_EQ(all.back().schedule.cycles, 0);
  add_program(all, "heat", shipped_rule("heat").program.program);
  add_program(all, "pair_law", pair_program(random_rule(4), 6));
  const Compared compared = expect_equal(all, 400);
  EXPECT_GT(compared.counting, compared.sets / 2);
  EXPECT_LT(compared.counting, compared.sets);
  EXPECT_GT(compared.faults, 100u);
}

// Of the full tier.
TEST(PrintedPipelineMore, OfRandomGraphsIsTheInterpreter) {
  Compared compared;
  for (uint64_t first = 100; first < 124; first += 6) {
    std::vector<Pipeline> all;
    add_random(all, first, 6, 40);
    const Compared some = expect_equal(all, 600);
    compared.faults += some.faults;
    for (const auto& [op, values] : some.by_op) compared.by_op[op] += values;
  }
  expect_all_ops(compared, 2000);
  EXPECT_GT(compared.faults, 1500u);
}

TEST(PrintedPipelineMore, OfShippedRulesIsTheInterpreter) {
  for (const char* rule : kShippedRules) {
    SCOPED_TRACE(rule);
    std::vector<Pipeline> all;
    add_program(all, rule, shipped_rule(rule).program.program);
    const Compared compared = expect_equal(all, 2000);
    EXPECT_GT(compared.counting, compared.sets / 2);
  }
}

TEST(PrintedPipelineMore, OfPairLawsIsTheInterpreter) {
  std::vector<Pipeline> all;
  for (uint64_t seed = 1; seed <= 6; ++seed)
    add_program(all, "law_" + std::to_string(seed), pair_program(random_rule(seed), 6));
  const Compared compared = expect_equal(all, 2000);
  EXPECT_GT(compared.faults, 1000u);
}

// Steps that take an input in the cycle in which it is done: a cycle sooner they get that of the set before.
// One per kind, or all of them.
std::vector<Pipeline> taken_too_soon(const Pipeline& right, size_t of_a_kind) {
  std::vector<Pipeline> all;
  std::map<Kind, size_t> count;
  const pipeline::Layout layout = pipeline::layout_of(right.schedule);
  for (int k = 0; k < static_cast<int>(right.schedule.at.size()); ++k) {
    const pipeline::Step& step = right.schedule.steps.steps[static_cast<size_t>(k)];
    if (step.inputs.empty() || pipeline::is_wire(step.kind) || layout.read[static_cast<size_t>(k)].empty())
      continue;
    const int start = pipeline::start_of(right.schedule, k);
    if (start == 0 || std::ranges::none_of(step.inputs, [&](int n) {
          return right.schedule.at[static_cast<size_t>(n)].cycle == start &&
                 right.schedule.steps.steps[static_cast<size_t>(n)].kind != Kind::constant;
        }))
      continue;
    if (++count[step.kind] > of_a_kind) continue;
    all.push_back(right);
    all.back().name += "_" + std::to_string(k);
    --all.back().schedule.at[static_cast<size_t>(k)].cycle;
  }
  return all;
}

std::set<Kind> expect_seen(const std::vector<Pipeline>& wrong) {
  std::set<Kind> kinds;
  std::vector<Difference> differences;
  compare(wrong, 200, 2, differences);
  for (size_t k = 0; k < wrong.size(); ++k) {
    const Pipeline& p = wrong[k];
    EXPECT_NE(pipeline::refusal_of(p.graph, p.outputs.nodes, p.schedule), "") << p.name;
    EXPECT_THROW(pipeline::print_pipeline(p.name, p.graph, p.outputs, p.schedule), std::logic_error);
    EXPECT_NE(differences[k].what, "") << p.name;
    const int step = std::stoi(p.name.substr(p.name.rfind('_') + 1));
    kinds.insert(p.schedule.steps.steps[static_cast<size_t>(step)].kind);
  }
  return kinds;
}

Pipeline first_pair(const graph::FixedProgram& program) { return pair_of("soon", program.rounds[0]); }

// Two products in a row, a table, choices, a rounding and a check.
Pipeline of_many_kinds() {
  graph::Builder b;
  const int x = b.input(graph::Source::own_field, 0, 0, {-255, 255}),
            y = b.input(graph::Source::own_field, 1, 0, {-255, 255});
  Dice dice(5);
  const FixedTable table = random_table(dice);
  const int r2 = b.clamp(b.dot({x, y}, {x, y}), graph::domain_of(table));
  const int force = b.mul(b.lookup(b.table(table), r2), x, 6);
  const int checked = b.check(b.mac(y, force, x, 4), 14, Fault::strength, b.lt(r2, b.constant(9000)));
  b.max(checked, b.shift(y, b.clamp(force, {-3, 3})));
  b.align(b.abs(b.msb(b.add(force, x))), 12);
  return all_of("soon", b.take(), -1);
}

TEST(PrintedPipeline, OfAStepTakenTooSoonIsSeen) {
  const std::set<Kind> kinds = expect_seen(taken_too_soon(of_many_kinds(), 1));
  EXPECT_GE(kinds.size(), 9u);
}

TEST(PrintedPipelineMore, OfAStepTakenTooSoonIsSeen) {
  std::set<Kind> kinds = expect_seen(taken_too_soon(first_pair(shipped_rule("copper").program.program), 4));
  kinds.merge(expect_seen(taken_too_soon(first_pair(shipped_rule("plastic").program.program), 2)));
  kinds.merge(expect_seen(taken_too_soon(all_of("any", random_graph(3, 30).graph, -1), 4)));
  EXPECT_GE(kinds.size(), 12u);
}

TEST(PrintedPipelineMore, OfGatesIsTheInterpreter) {
  std::vector<Pipeline> all{of_many_kinds()};
  add_program(all, "heat", shipped_rule("heat").program.program);
  std::vector<Difference> differences;
  const Compared compared = compare(all, 300, 3, differences, Form::gates);
  for (const Difference& difference : differences) EXPECT_EQ(difference.what, "");
  EXPECT_EQ(compared.sets, 300 * all.size());
  EXPECT_GT(compared.faults, 20u);
}

// Without a warning.
void expect_read_by_all_tools(const std::string& rule) {
  namespace fs = std::filesystem;
  std::vector<Pipeline> all;
  add_program(all, rule, shipped_rule(rule).program.program);
  for (const Pipeline& p : all) {
    const fs::path dir = fs::path(testing::TempDir()) / "cuboct_pipeline_lint" / p.name;
    fs::create_directories(dir);
    std::string files = CUBOCT_SOURCE_DIR "/rtl/lib/arithmetic/cuboct_mult.sv " CUBOCT_SOURCE_DIR
                                          "/rtl/pipeline/cuboct_leading_zeros.sv";
    for (const pipeline::Module& module : pipeline::print_pipeline(p.name, p.graph, p.outputs, p.schedule)) {
      write_text((dir / (module.name + ".sv")).string(), module.text);
      files += " " + module.name + ".sv";
    }
    for (const std::string& command :
         {fmt::format("verilator --lint-only -Wall --top-module {} {}", p.name, files),
          fmt::format("iverilog -g2012 -Wall -Wno-timescale -s {} -o /dev/null {}", p.name, files),
          fmt::format("yosys -q -p 'read_verilog -sv {}; hierarchy -check -top {}; proc; check -assert'",
                      files, p.name)}) {
      const std::string log = (dir / "log").string();
      EXPECT_EQ(std::system(fmt::format("cd {} && {} > {} 2>&1", dir.string(), command, log).c_str()), 0)
          << command;
      EXPECT_EQ(read_text(log), "") << command;
    }
  }
}

TEST(PrintedPipeline, IsReadByAllToolsWithoutAWarning) { expect_read_by_all_tools("heat"); }

TEST(PrintedPipelineMore, IsReadByAllToolsWithoutAWarning) {
  for (const char* rule : kShippedRules) expect_read_by_all_tools(rule);
}

TEST(PrintedPipeline, HasPortsByTheIntervals) {
  graph::Builder b;
  const int x = b.input(graph::Source::own_field, 2, 1, {-100, 90});
  const int far = b.lt(b.constant(50), x);
  graph::Graph graph = b.take();
  const pipeline::Outputs outputs{{far, x}, {"far", "same"}};
  const auto modules =
      pipeline::print_pipeline("ported", graph, outputs, pipeline::schedule_of(graph, outputs.nodes));
  ASSERT_EQ(modules.size(), 1u);
  EXPECT_EQ(
      modules[0].text,
      "// SPDX-License-Identifier: MIT\n"
      "// One set of inputs per cycle; its outputs 1 cycle later. The ports of docs/reference/pipeline.md.\n"
      "module ported (\n"
      "  input  logic clk_i,\n"
      "  input  logic rst_ni,\n"
      "  input  logic valid_i,\n"
      "  input  logic signed [7:0] own_field_2_1_i,\n"
      "  output logic valid_o,\n"
      "  output logic far_o,\n"
      "  output logic signed [7:0] same_o\n"
      ");\n"
      "  logic [7:0] s0_1;\n"
      "  logic s2;  // lt 2\n"
      "  logic s2_1;\n"
      "\n"
      "  assign s2 = $signed(8'h32) < $signed(own_field_2_1_i);\n"
      "  always_ff @(posedge clk_i) begin\n"
      "    s0_1 <= own_field_2_1_i;\n"
      "    s2_1 <= s2;\n"
      "  end\n"
      "\n"
      "  logic valid_q;\n"
      "  always_ff @(posedge clk_i) begin\n"
      "    if (!rst_ni) valid_q <= '0;\n"
      "    else valid_q <= valid_i;\n"
      "  end\n"
      "  assign valid_o = valid_q;\n"
      "  assign far_o = s2_1;\n"
      "  assign same_o = s0_1;\n"
      "endmodule\n");
}

}  // namespace
}  // namespace cuboct::test
