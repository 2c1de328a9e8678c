// SPDX-License-Identifier: MIT
// Steps beside the interpreter; schedules beside a checker that shares nothing with what made them.
#include "hw/pipeline/schedule.h"

#include <gtest/gtest.h>

#include "hw/pipeline/schedule_check.h"
#include "tests/graph/random_graph.h"
#include "tests/pipeline/pipelines.h"
#include "tests/pipeline/rules.h"
#include "tests/pipeline/step_values.h"

namespace cuboct::test {
namespace {

using graph::Graph;
using graph::Op;
using pipeline::Kind;
using pipeline::Schedule;

constexpr size_t kLanes = 200;

// All but constants: each is an output.
std::vector<int> all_values(const Graph& graph) {
  std::vector<int> all;
  for (int n = 0; n < static_cast<int>(graph.nodes.size()); ++n)
    if (graph.nodes[static_cast<size_t>(n)].op != Op::constant) all.push_back(n);
  return all;
}

TEST(PipelineSteps, AreWorthWhatTheInterpreterSays) {
  std::map<Op, uint64_t> met;
  std::map<Kind, uint64_t> kinds;
  uint64_t faults = 0, hidden = 0;
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    const Drawn drawn = random_graph(seed, 50);
    const Graph& graph = drawn.graph;
    const std::vector<int> outputs = all_values(graph);
    const pipeline::Steps steps = pipeline::steps_of(graph, outputs);
    for (const pipeline::Step& step : steps.steps) ++kinds[step.kind];
    const std::vector<bool> alone = taken_for_granted(graph);
    bool fault_alone = false;
    for (size_t n = 0; n < alone.size(); ++n)
      fault_alone = fault_alone || (graph.nodes[n].op == Op::check && alone[n]);
    graph::Block<int64_t> block(graph, kLanes);
    run_all(block, graph, seed, kLanes);
    for (size_t lane = 0; lane < kLanes; ++lane) {
      std::vector<int64_t> inputs;
      for (const pipeline::Port& port : steps.inputs) inputs.push_back(block.values(port.node)[lane]);
      const bool counts = drawn.when < 0 || block.values(drawn.when)[lane] != 0;
      const std::vector<Wide> values = values_of(steps, graph.tables, inputs);
      for (const pipeline::Port& port : steps.outputs) {
        const auto n = static_cast<size_t>(port.node);
        if (!counts && alone[n]) {
          ++hidden;
          continue;
        }
        ASSERT_EQ(static_cast<int64_t>(values[static_cast<size_t>(port.step)]), block.values(port.node)[lane])
            << "seed " << seed << ", lane " << lane << ", " << label(graph, port.node);
        ++met[graph.nodes[n].op];
      }
      if (!counts && fault_alone) continue;
      const auto found = std::ranges::find(block.faults(), static_cast<int>(lane), &graph::LaneFault::lane);
      const bool failed = found != block.faults().end();
      const auto value = [&](int step) { return static_cast<int64_t>(values[static_cast<size_t>(step)]); };
      ASSERT_EQ(steps.fault >= 0 && value(steps.fault) != 0, failed) << "seed " << seed << ", lane " << lane;
      if (!failed) continue;
      ++faults;
      ASSERT_EQ(value(steps.fault_code), static_cast<int64_t>(found->fault)) << "seed " << seed;
      ASSERT_EQ(value(steps.fault_number), found->number) << "seed " << seed << ", lane " << lane;
    }
  }
  for (int op = static_cast<int>(Op::input); op <= static_cast<int>(Op::noise); ++op)
    EXPECT_GT(met[static_cast<Op>(op)], 1000u) << to_string(static_cast<Op>(op));
  for (int kind = 0; kind < pipeline::kKinds; ++kind) EXPECT_GT(kinds[static_cast<Kind>(kind)], 50u) << kind;
  EXPECT_GT(faults, 2000u);
  EXPECT_GT(hidden, 1000u);
}

// Each output of the steps in all lanes, where the pair counts.
uint64_t expect_equal_steps(const Graph& graph, const std::vector<int>& outputs, int when, uint64_t seed,
                            const std::string& name) {
  const pipeline::Steps steps = pipeline::steps_of(graph, outputs);
  graph::Block<int64_t> block(graph, kLanes);
  run_all(block, graph, seed, kLanes);
  uint64_t compared = 0;
  for (size_t lane = 0; lane < kLanes; ++lane) {
    if (when >= 0 && block.values(when)[lane] == 0) continue;
    std::vector<int64_t> inputs;
    for (const pipeline::Port& port : steps.inputs) inputs.push_back(block.values(port.node)[lane]);
    const std::vector<Wide> values = values_of(steps, graph.tables, inputs);
    for (const pipeline::Port& port : steps.outputs) {
      EXPECT_EQ(static_cast<int64_t>(values[static_cast<size_t>(port.step)]), block.values(port.node)[lane])
          << name << ", lane " << lane << ", " << label(graph, port.node);
      ++compared;
    }
  }
  return compared;
}

// Factors of every width that a product has room for, with and without a sign, and squares.
TEST(PipelineSteps, MultiplyAllWidths) {
  for (int wide = 1; wide <= 60; ++wide)
    for (int narrow = 1; narrow <= std::min(wide, 61 - wide); narrow += narrow < 20 ? 1 : 5) {
      graph::Builder b;
      const auto input = [&](int index, int bits, bool is_signed) {
        const int64_t most = (int64_t{1} << bits) - 1;
        return b.input(graph::Source::own_field, index, 0, {is_signed ? -most - 1 : 0, most});
      };
      const int a = input(0, wide, true), c = input(1, wide, false), x = input(2, narrow, true),
                y = input(3, narrow, false);
      std::vector<int> products = {
          b.mul(a, x), b.mul(a, y), b.mul(c, x), b.mul(c, y), b.mul(x, x, narrow / 2), b.mul(y, y)};
      for (int s = 1; s < wide + narrow; s += 7) products.push_back(b.mul(a, x, s));
      const Graph graph = b.take();
      expect_equal_steps(graph, products, -1, static_cast<uint64_t>(wide * 64 + narrow),
                         "factors of " + std::to_string(wide) + " and " + std::to_string(narrow) + " bits");
    }
}

TEST(PipelineSteps, OfShippedRulesAreWorthWhatTheInterpreterSays) {
  for (const char* name : kShippedRules) {
    const InIntegers made = shipped_rule(name);
    for (const graph::Round& round : made.program.program.rounds) {
      EXPECT_GT(expect_equal_steps(round.pair, pipeline::piped_outputs(round), round.when, 3, name), 0u)
          << name;
      EXPECT_GE(
          expect_equal_steps(round.finish, graph::finish_outputs(made.program.program, round), -1, 4, name),
          kLanes);
    }
  }
}

void expect_accepted(const Graph& graph, const std::vector<int>& outputs, const std::string& name) {
  const Schedule schedule = pipeline::schedule_of(graph, outputs);
  EXPECT_EQ(pipeline::refusal_of(graph, outputs, schedule), "") << name;
  const Schedule again = pipeline::schedule_of(graph, outputs);
  EXPECT_EQ(again.at, schedule.at) << name;
}

TEST(PipelineSchedule, OfRandomGraphsIsAccepted) {
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    const Graph graph = random_graph(seed, 60).graph;
    expect_accepted(graph, all_values(graph), "seed " + std::to_string(seed));
  }
}

TEST(PipelineSchedule, OfShippedRulesIsAccepted) {
  for (const char* name : kShippedRules) {
    const InIntegers made = shipped_rule(name);
    for (const graph::Round& round : made.program.program.rounds) {
      expect_accepted(round.pair, pipeline::piped_outputs(round), std::string(name) + " pair " + round.name);
      expect_accepted(round.finish, graph::finish_outputs(made.program.program, round),
                      std::string(name) + " finish " + round.name);
    }
  }
}

// Of every step that a clock or a delay holds back: a cycle sooner, and half of its delay sooner.
TEST(PipelineSchedule, AStepThatIsTooSoonIsRefused) {
  std::map<Kind, int> refused;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const Graph graph = random_graph(seed, 40).graph;
    const std::vector<int> outputs = all_values(graph);
    const Schedule right = pipeline::schedule_of(graph, outputs);
    for (size_t k = 0; k < right.at.size(); ++k) {
      const pipeline::Step& step = right.steps.steps[k];
      if (step.kind == Kind::constant || right.at[k] == pipeline::Moment{}) continue;
      Schedule wrong = right;
      wrong.at[k] = right.at[k].cycle > 0 ? pipeline::Moment{right.at[k].cycle - 1, right.at[k].ps}
                                          : pipeline::Moment{0, right.at[k].ps / 2};
      EXPECT_NE(pipeline::refusal_of(graph, outputs, wrong), "") << "seed " << seed << ", step " << k;
      ++refused[step.kind];
    }
  }
  for (const Kind kind :
       {Kind::slice, Kind::join, Kind::add, Kind::sub, Kind::less, Kind::choose, Kind::carry, Kind::leading,
        Kind::shift_left, Kind::product, Kind::rom, Kind::unfit})
    EXPECT_GT(refused[kind], 5) << static_cast<int>(kind);
}

class PipelineRefusals : public testing::Test {
 protected:
  PipelineRefusals() {
    graph::Builder b;
    const int x = b.input(graph::Source::own_field, 0, 0, {-1000, 1000}), y = b.add(x, b.constant(77));
    const int far = b.check(b.mul(y, x), 12, Fault::strength);
    outputs = {b.named(b.add(far, x), "sum"), b.named(y, "y")};
    graph = b.take();
    schedule = pipeline::schedule_of(graph, outputs);
  }
  std::string refusal() const { return pipeline::refusal_of(graph, outputs, schedule); }
  pipeline::Moment& at(int step) { return schedule.at[static_cast<size_t>(step)]; }

  Graph graph;
  std::vector<int> outputs;
  Schedule schedule;
};

TEST_F(PipelineRefusals, NothingIsWrong) { EXPECT_EQ(refusal(), ""); }

TEST_F(PipelineRefusals, AnOutputIsDropped) {
  schedule.steps.outputs.pop_back();
  EXPECT_EQ(refusal(), "the schedule has other outputs");
}

TEST_F(PipelineRefusals, AnOutputIsMadeOfAnotherNode) {
  std::swap(schedule.steps.outputs[0], schedule.steps.outputs[1]);
  EXPECT_EQ(refusal(), "the schedule has other outputs");
}

TEST_F(PipelineRefusals, ThePipelineEndsTooSoon) {
  --schedule.cycles;
  EXPECT_NE(refusal().find("and the pipeline ends in cycle"), std::string::npos) << refusal();
}

TEST_F(PipelineRefusals, AFaultIsDropped) {
  schedule.steps.fault = schedule.steps.of_node[static_cast<size_t>(outputs[1])];
  EXPECT_NE(refusal().find("no fault tells of 'check"), std::string::npos) << refusal();
  schedule.steps.fault = -1;
  EXPECT_EQ(refusal(), "nothing makes the fault");
}

TEST_F(PipelineRefusals, AChainIsLongerThanACycle) {
  at(schedule.steps.fault).ps = pipeline::kDelays.room() + 1;
  EXPECT_NE(refusal().find("beyond the"), std::string::npos) << refusal();
}

TEST_F(PipelineRefusals, ANodeIsReadySooner) {
  --schedule.ready[static_cast<size_t>(outputs[0])];
  EXPECT_NE(refusal().find("is not ready in cycle"), std::string::npos) << refusal();
}

}  // namespace
}  // namespace cuboct::test
