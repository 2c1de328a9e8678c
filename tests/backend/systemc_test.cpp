// SPDX-License-Identifier: MIT
// The SystemC bench: the same bits as golden and the same cycles as the plain loop, with and without stalls.
// SystemC elaborates once per process, so ctest runs one test per process.
#include <gtest/gtest.h>

#include "emu/machine/bench.h"
#include "emu/systemc/node.h"
#include "tests/backend/engines.h"
#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

class SystemC : public testing::TestWithParam<std::string> {};

// A bench without and one with stalls, in one simulation.
TEST_P(SystemC, EqualsGoldenAndThePlainLoop) {
  const Case c = make_case(GetParam());
  const Plan& plan = c.setup.plan;
  const emu::NodeFactory nodes = emu::native_nodes(plan);
  const auto free = keep_all(c.steps), stalled = keep_all(c.steps, 0.3, 7);
  emu::Bench free_bench("free", plan, c.setup.initial, free, nodes, "systemc");
  emu::Bench stalled_bench("stalled", plan, c.setup.initial, stalled, nodes, "systemc");
  emu::simulate({&free_bench, &stalled_bench});
  const emu::RunResult a = free_bench.take_result(), b = stalled_bench.take_result();

  const GoldenRun golden = run_golden(c.setup, c.steps);
  for (const emu::RunResult* run : {&a, &b}) {
    const Compared compared = compare(plan, golden, *run);
    EXPECT_EQ(compared.difference, "");
    EXPECT_EQ(compared.steps, c.steps + 1);
    EXPECT_EQ(compared.slots, (c.steps + 1) * c.setup.initial.particles.size());
  }
  const uint64_t spans = c.steps * plan.nodes() * kPhases;
  const Compared with_plain = compare_cycles(a, run_loop_bench(plan, c.setup.initial, free, nodes, "plain"));
  EXPECT_EQ(with_plain.difference, "");
  EXPECT_EQ(with_plain.spans, spans);
  const Compared with_stalled =
      compare_cycles(b, run_loop_bench(plan, c.setup.initial, stalled, nodes, "plain"));
  EXPECT_EQ(with_stalled.difference, "");
  EXPECT_EQ(with_stalled.spans, spans);
  EXPECT_EQ(a.trace.cycles == b.trace.cycles, plan.nodes() == 1);
}

INSTANTIATE_TEST_SUITE_P(Cases, SystemC, testing::ValuesIn(case_names()),
                         [](const auto& p) { return p.param; });

// Nodes of several cases in one simulation, each without and with stalls. `name`: of their benches.
void expect_golden_and_the_plain_loop(const std::string& name, const std::vector<Case>& cases) {
  constexpr double kRates[] = {0.0, 0.3};
  std::vector<std::unique_ptr<emu::Bench>> benches;
  std::vector<emu::Bench*> all;
  for (const Case& c : cases)
    for (const double rate : kRates) {
      benches.push_back(std::make_unique<emu::Bench>(
          (name + std::to_string(benches.size())).c_str(), c.setup.plan, c.setup.initial,
          keep_all(c.steps, rate, 7), emu::native_nodes(c.setup.plan), "systemc"));
      all.push_back(benches.back().get());
    }
  emu::simulate(all);
  for (size_t k = 0; k < benches.size(); ++k) {
    const Case& c = cases[k / 2];
    const Plan& plan = c.setup.plan;
    const emu::RunResult run = benches[k]->take_result();
    const Compared compared = compare(plan, run_golden(c.setup, c.steps), run);
    EXPECT_EQ(compared.difference, "") << c.name;
    EXPECT_EQ(compared.steps, c.steps + 1);
    const auto options = keep_all(c.steps, kRates[k % 2], 7);
    const Compared with_plain =
        compare_cycles(run, run_loop_bench(plan, c.setup.initial, options, emu::native_nodes(plan), "plain"));
    EXPECT_EQ(with_plain.difference, "") << c.name;
    EXPECT_EQ(with_plain.spans, c.steps * plan.nodes() * kPhases);
  }
}

// A node linked to itself, two nodes linked twice, ragged ones, checked links.
TEST(SystemCBricks, EqualGoldenAndThePlainLoop) {
  std::vector<Case> cases;
  for (const auto& [name, brick] :
       std::initializer_list<std::pair<const char*, Cell>>{{"periodic_27", {3, 2, 1}},
                                                           {"flat_ring", {2, 2, 1}},
                                                           {"hot_gas", {3, 4, 2}},
                                                           {"rich_damped.retry", {2, 2, 2}},
                                                           {"undamped_2x2x2", {2, 2, 2}}})
    cases.push_back(with_brick(make_case(name), brick));
  expect_golden_and_the_plain_loop("bench", cases);
}

// Links between devices: nodes of each kind.
TEST(SystemCBoards, EqualGoldenAndThePlainLoop) {
  std::vector<Case> cases;
  for (const auto& [name, cut] :
       std::initializer_list<std::pair<const char*, DeviceCut>>{{"undamped_2x2x2", {{1, 2, 1}, 1, 1}},
                                                                {"undamped_2x2x2", {{1, 2, 1}, 13, 3}},
                                                                {"arrival_ring", {{1, 1, 1}, 9, 5}},
                                                                {"arrival_two", {{2, 2, 2}, 17, 3}},
                                                                {"brick_serial", {{1, 1, 1}, 12, 2}},
                                                                {"flat_ring", {{2, 1, 1}, 9, 4}}}) {
    cases.push_back(with_boards(make_case(name), cut));
    EXPECT_FALSE(cases.back().setup.plan.cut.empty()) << name;
  }
  expect_golden_and_the_plain_loop("boards", cases);
}

// A native node that is called in every cycle.
class Restless : public emu::NodeModel {
 public:
  explicit Restless(std::unique_ptr<emu::NodeModel> inner) : inner_(std::move(inner)) {}
  void clock(const emu::NodeInputs& in, emu::NodeOutputs& out) override { inner_->clock(in, out); }
  emu::Counters counters(uint64_t end) const override { return inner_->counters(end); }

 private:
  std::unique_ptr<emu::NodeModel> inner_;
};

double counted(const emu::RunResult& run, const std::string& name) {
  for (const auto& [key, value] : run.trace.counters)
    if (key == name) return value;
  ADD_FAILURE() << "no counter " << name;
  return 0;
}

// Each case has nodes that wait for neighbours of more particles, with and without stalls, and with narrow
// links.
TEST(SystemCSleep, ChangesNothingButTheNumberOfCalls) {
  std::vector<std::unique_ptr<Case>> cases;
  std::vector<std::unique_ptr<emu::Bench>> benches;
  std::vector<emu::Bench*> all;
  for (const std::string name : {"undamped_2x2x2", "lattice_3x2x1", "two_pipes", "wide_links"})
    for (const double rate : {0.0, 0.3}) {
      const Case& c = *cases.emplace_back(std::make_unique<Case>(make_case(name)));
      const Plan& plan = c.setup.plan;
      const emu::NodeFactory nodes = emu::native_nodes(plan),
                             restless = [nodes](uint32_t node, uint8_t has_link) {
                               return std::make_unique<Restless>(nodes(node, has_link));
                             };
      for (const auto& [prefix, factory] : {std::pair{"sleeping", nodes}, {"restless", restless}}) {
        const std::string bench = prefix + std::to_string(benches.size());
        benches.push_back(std::make_unique<emu::Bench>(bench.c_str(), plan, c.setup.initial,
                                                       keep_all(c.steps, rate, 5), factory, prefix));
        all.push_back(benches.back().get());
      }
    }
  emu::simulate(all);
  for (size_t k = 0; k < cases.size(); ++k) {
    const double nodes = cases[k]->setup.plan.lattice.size();
    const emu::RunResult sleeping = benches[2 * k]->take_result(),
                         restless = benches[2 * k + 1]->take_result();
    const Compared compared = compare_cycles(restless, sleeping);
    EXPECT_EQ(compared.difference, "") << cases[k]->name;
    EXPECT_EQ(compared.spans, cases[k]->steps * static_cast<uint64_t>(nodes) * kPhases);
    const double cycles = counted(restless, "cycles");
    for (const auto& [name, value] : restless.trace.counters)
      if (name != "node_calls") {
        EXPECT_EQ(value, counted(sleeping, name)) << name;
      }
    // The cycle in which the host sees the end may count in some nodes.
    EXPECT_NEAR(counted(restless, "node_calls"), cycles * nodes, nodes);
    EXPECT_LT(counted(sleeping, "node_calls"), 0.8 * cycles * nodes) << cases[k]->name;
    EXPECT_GT(counted(sleeping, "node_calls"), 0.05 * cycles * nodes) << cases[k]->name;
  }
  EXPECT_EQ(cases.size(), 8u);
}

// A link's word beyond the record is zero, whatever the register held before.
TEST(SystemCLinks, RecordsAreZeroPadded) {
  class Watched : public emu::NodeModel {
   public:
    Watched(std::unique_ptr<emu::NodeModel> inner, const Words& words, std::array<uint64_t, 2>& seen)
        : inner_(std::move(inner)), words_(words), seen_(seen) {}
    void clock(const emu::NodeInputs& in, emu::NodeOutputs& out) override {
      for (size_t f = 0; f < kFaces; ++f) {
        if (!(in.valid >> f & 1)) continue;
        const emu::Beat& beat = *in.beat[f];
        // Streams alternate: halo, migrate, ...
        const int bits = beat.end ? 0 : migrating_[f] ? words_.particle_bits : words_.halo_bits;
        EXPECT_EQ(beat.payload.slice(bits, emu::Bits::kWidth), emu::Bits{});
        if (beat.end)
          migrating_[f] = !migrating_[f];
        else
          ++seen_[migrating_[f]];
      }
      inner_->clock(in, out);
    }

   private:
    std::unique_ptr<emu::NodeModel> inner_;
    const Words& words_;
    std::array<uint64_t, 2>& seen_;
    std::array<bool, kFaces> migrating_{};
  };
  const Case c = make_case("wide_links");
  const Plan& plan = c.setup.plan;
  ASSERT_GT(plan.words.link_bits, (plan.words.halo_bits + 63) / 64 * 64);
  const emu::NodeFactory nodes = emu::native_nodes(plan);
  std::array<uint64_t, 2> seen{};
  const auto watched = [&](uint32_t node, uint8_t has_link) {
    return std::make_unique<Watched>(nodes(node, has_link), plan.words, seen);
  };
  emu::Bench bench("bench", plan, c.setup.initial, keep_all(c.steps), watched, "systemc");
  emu::simulate({&bench});
  EXPECT_GT(seen[0], 100u);
  EXPECT_GT(seen[1], 0u);
}

TEST(SystemCFaults, EachArisesAsInGolden) {
  std::vector<std::unique_ptr<Case>> cases;
  std::vector<std::unique_ptr<emu::Bench>> benches;
  std::vector<emu::Bench*> all;
  for (const Fault fault : all_faults()) {
    cases.push_back(std::make_unique<Case>(fault_case(fault)));
    const auto& setup = cases.back()->setup;
    const std::string name = "bench_" + std::to_string(cases.size());
    benches.push_back(std::make_unique<emu::Bench>(name.c_str(), setup.plan, setup.initial, keep_all(30),
                                                   emu::native_nodes(setup.plan), "systemc"));
    all.push_back(benches.back().get());
  }
  emu::simulate(all);
  for (size_t k = 0; k < cases.size(); ++k) {
    const emu::RunResult run = benches[k]->take_result();
    EXPECT_EQ(compare(cases[k]->setup.plan, run_golden(cases[k]->setup, 30), run).difference, "")
        << cases[k]->name;
    ASSERT_TRUE(run.trace.stop) << cases[k]->name;
    EXPECT_EQ(run.trace.stop->fault, all_faults()[k]);
  }
  EXPECT_EQ(cases.size(), 11u);
}

// A node that never answers: the bench says who waits and for what.
TEST(SystemCStuck, NamesTheNodes) {
  class Dead : public emu::NodeModel {
    void clock(const emu::NodeInputs&, emu::NodeOutputs& out) override { out = {}; }
    std::string doing() const override { return "dead"; }
  };
  const Case c = make_case("lattice_3x2x1");
  const emu::NodeFactory live = emu::native_nodes(c.setup.plan);
  emu::RunOptions options = keep_all(1);
  options.patience = 500;
  emu::Bench bench(
      "bench", c.setup.plan, c.setup.initial, options,
      [&](uint32_t node, uint8_t has_link) -> std::unique_ptr<emu::NodeModel> {
        if (node == 5) return std::make_unique<Dead>();
        return live(node, has_link);
      },
      "systemc");
  emu::simulate({&bench});
  try {
    bench.take_result();
    FAIL();
  } catch (const std::runtime_error& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("\n  node 4 (1,1,0): step 0, exchange_x: waits for"), std::string::npos) << text;
    EXPECT_NE(text.find("\n  node 5 (2,1,0): dead"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace cuboct::test
