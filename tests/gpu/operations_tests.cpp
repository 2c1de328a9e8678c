// SPDX-License-Identifier: MIT
// Operations of the gpu engine's interpreter beside golden's, of graphs drawn at random.
#include "emu/gpu/rounds/rounds_operations.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "model/graph/registers.h"
#include "tests/graph/random_graph.h"

namespace cuboct::test {
namespace {

constexpr int kInputs = 10, kOutputs = 20;  // fields; random_graph reads the first ones
constexpr size_t kLanes = gpu::kTogether;

size_t index(int n) { return static_cast<size_t>(n); }

// One round, whose finish makes a field of each of the last values.
graph::FixedProgram program_of(const graph::Graph& graph) {
  graph::FixedProgram program;
  program.fields.resize(kInputs + kOutputs);
  graph::Builder pair;
  graph::Round round;
  round.when = pair.constant(1);
  round.pair = pair.take();
  round.finish = graph;
  int node = static_cast<int>(graph.nodes.size());
  for (int k = 0; k < kOutputs && node > 0; ++k) round.writes.push_back({kInputs + k, 0, --node});
  program.rounds.push_back(round);
  return program;
}

class Interpreter {
 public:
  explicit Interpreter(const graph::FixedProgram& program)
      : stream_(0),
        device_(stream_, program),
        code_(device_.rounds().front()),
        registers_(index(code_.registers)) {
    for (int k = 0; k < code_.finish_constants.count; ++k) {
      const gpu::Constant& constant = code_.finish_constants.data[k];
      r_.put_all(constant.to, constant.wide, constant.value);
    }
  }

  // `value(field, lane)`
  template <class F>
  void fetch(const F& value) {
    for (uint32_t k = 0; k < code_.finish_fetch.count; ++k) {
      const gpu::Fetch& fetch = part(code_.finish_fetch)[k];
      for (size_t l = 0; l < kLanes; ++l)
        r_.put_lane(fetch.to, fetch.wide, static_cast<int>(l), round_odd(value(fetch.index, l), fetch.shift));
    }
  }
  // Lanes with a fault.
  uint32_t run_together() {
    return gpu::Lanes(r_, code_.finish_tables).run(part(code_.finish), code_.finish.count);
  }
  uint32_t run_one_by_one() {
    uint32_t wrong = 0;
    for (uint32_t k = 0; k < code_.finish.count; ++k)
      for (int l = 0; l < gpu::kTogether; ++l)
        wrong |= uint32_t{!gpu::operate(part(code_.finish)[k], r_, l, code_.finish_tables)} << l;
    return wrong;
  }
  int64_t output(size_t k, size_t lane) const {
    const gpu::Store& store = part(code_.writes)[k];
    return r_.lane(store.from, store.wide, static_cast<int>(lane));
  }
  template <class F>
  void for_each_operation(const F& f) const {
    for (uint32_t k = 0; k < code_.finish.count; ++k) f(part(code_.finish)[k]);
  }

 private:
  template <typename T>
  const T* part(const gpu::Part<T>& part) const {
    return reinterpret_cast<const T*>(code_.image.data + part.line);
  }
  gpu::Stream stream_;
  gpu::ProgramOnDevice device_;
  gpu::RoundCode code_;
  std::vector<gpu::Quad> registers_;
  gpu::RoundsRegisters r_{registers_.data(), 1};
};

TEST(InterpretedOperations, HaveGoldensValues) {
  std::map<std::pair<graph::Op, bool>, int> met;  // by narrow
  int faults = 0, repeated = 0, joined = 0;
  for (uint64_t seed = 1; seed <= 1000; ++seed) {
    const graph::Graph graph = random_graph(seed, 40).graph;
    const graph::FixedProgram program = program_of(graph);
    const std::vector<int> outputs = finish_outputs(program, program.rounds.front());
    const std::vector<int> nodes = needed_by(graph, outputs);
    graph::Block<int64_t> golden(graph, kLanes);
    std::map<int, std::vector<int64_t>> fields;
    Dice dice(seed);
    for (const int n : nodes) {
      const graph::Node& node = graph.nodes[index(n)];
      if (node.op != graph::Op::input) continue;
      std::vector<int64_t>& field = fields[node.index];
      for (size_t k = 0; k < kLanes; ++k)
        field.push_back(golden.values(n)[k] = random_value(dice, node.range));
    }
    std::vector<int> computed;
    std::ranges::copy_if(nodes, std::back_inserter(computed),
                         [&](int n) { return graph::is_computed(graph.nodes[index(n)]); });
    golden.run(computed, kLanes);
    uint32_t expected = 0;
    for (const graph::LaneFault& fault : golden.faults()) expected |= 1u << fault.lane;
    faults += expected != 0;

    Interpreter interpreter(program);
    for (const bool together : {true, false}) {
      interpreter.fetch([&](int field, size_t lane) { return fields.at(field)[lane]; });
      EXPECT_EQ(together ? interpreter.run_together() : interpreter.run_one_by_one(), expected)
          << "seed " << seed;
      for (size_t k = 0; k < outputs.size(); ++k)
        for (size_t l = 0; l < kLanes; ++l)
          ASSERT_EQ(interpreter.output(k, l), golden.values(outputs[k])[l])
              << "seed " << seed << ", " << label(graph, outputs[k]) << ", lane " << l << ", together "
              << together;
    }
    interpreter.for_each_operation([&](const gpu::Operation& o) {
      const auto op = static_cast<graph::Op>(o.op());
      ++met[{op, o.narrow()}];
      repeated += o.more();
      joined += op == graph::Op::mul && o.shift() > 0;
    });
  }
  for (int op = static_cast<int>(graph::Op::add); op <= static_cast<int>(graph::Op::noise); ++op) {
    const auto of = static_cast<graph::Op>(op);
    EXPECT_GT((met[{of, true}] + met[{of, false}]), 100) << to_string(of);
    // Truths have one bit, and arguments of these tables 18.
    if (of != graph::Op::both && of != graph::Op::either && of != graph::Op::negate &&
        of != graph::Op::lookup) {
      EXPECT_GT((met[{of, true}]), 20) << to_string(of);
      EXPECT_GT((met[{of, false}]), 20) << to_string(of);
    }
  }
  EXPECT_GT(faults, 50);
  EXPECT_GT(repeated, 1000);
  EXPECT_GT(joined, 100);
}

// Half is added to what a rounding in 32 bits takes, and their last value has no room for it.
TEST(InterpretedOperations, RoundAtTheEndOf32Bits) {
  constexpr int64_t kMost = (int64_t{1} << 31) - 1;
  for (const int64_t most : {kMost - 2048, kMost - 2047, kMost}) {
    graph::Builder b;
    const int x = b.input(graph::Source::own_field, 0, 0, {-most, most});
    b.round(b.min(x, b.input(graph::Source::own_field, 1, 0, {-most, most})), 12);
    const graph::FixedProgram program = program_of(b.take());
    Interpreter interpreter(program);
    interpreter.for_each_operation([&](const gpu::Operation& o) {
      if (static_cast<graph::Op>(o.op()) == graph::Op::round) {
        EXPECT_EQ(o.narrow(), most == kMost - 2048);
      }
    });
    for (const bool together : {true, false}) {
      interpreter.fetch([&](int, size_t lane) { return lane % 2 == 0 ? most : -most; });
      EXPECT_EQ(together ? interpreter.run_together() : interpreter.run_one_by_one(), 0u);
      for (size_t l = 0; l < kLanes; ++l)
        EXPECT_EQ(interpreter.output(0, l), round_odd(l % 2 == 0 ? most : -most, 12)) << most;
    }
  }
}

}  // namespace
}  // namespace cuboct::test
