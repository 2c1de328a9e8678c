// SPDX-License-Identifier: MIT
// The emitted hardware behind the same bench: golden's bits, the native node's cycles. One test per process,
// as for systemc_test.cpp; compiled nodes stay in the build tree.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <systemc>

#include "emu/machine/bench.h"
#include "emu/machine/program.h"
#include "emu/machine/words.h"
#include "emu/systemc/node.h"
#include "emu/verilated/verilated_node.h"
#include "tests/backend/engines.h"
#include "tests/support/cases.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

constexpr const char* kCache = CUBOCT_TEST_CACHE;
// Of the C++ compiler: a model of few cycles takes longer to compile than to run.
constexpr const char* kOptimise = "-O0";

emu::NodeFactory verilated_nodes(const Plan& plan, uint32_t seed = 0) {
  return emu::verilated_nodes(plan, kCache, seed, kOptimise);
}

// Cases that between them need few compiled nodes: the first four share one.
std::vector<std::string> rtl_cases() {
  return {"undamped_2x2x2", "lattice_3x2x1",    "hot_gas",
          "lone_diagonal",  "rich_damped",      "rich_force_held",
          "rich_ring",      "rich_shared",      "rich_narrow",
          "flat",           "flat_rich_damped", "flat_rich_force_held",
          "flat_ring",      "flat_narrow",      "arrival_one",
          "arrival_two",    "arrival_ring",     "flat_arrival"};
}

class Rtl : public testing::TestWithParam<std::string> {};

double counter_of(const emu::RunResult& run, const std::string& name) {
  for (const auto& [key, value] : run.trace.counters)
    if (key == name) return value;
  return -1;
}

// Native and Verilated nodes, without and with stalls: four lattices in one simulation. The Verilated
// registers start as random bits in one of them: nothing may hang on what reset leaves alone.
void expect_golden(const Case& c) {
  const Plan& plan = c.setup.plan;
  const emu::NodeFactory native = emu::native_nodes(plan), verilated = verilated_nodes(plan),
                         random = verilated_nodes(plan, 17);
  const auto free = keep_all(c.steps), stalled = keep_all(c.steps, 0.3, 7);
  auto threaded = free;
  threaded.threads = 3;
  emu::Bench native_free("native_free", plan, c.setup.initial, threaded, native, "systemc");
  emu::Bench native_stalled("native_stalled", plan, c.setup.initial, stalled, native, "systemc");
  emu::Bench rtl_free("rtl_free", plan, c.setup.initial, threaded, verilated, "rtl");
  emu::Bench rtl_stalled("rtl_stalled", plan, c.setup.initial, stalled, random, "rtl");
  emu::simulate({&native_free, &native_stalled, &rtl_free, &rtl_stalled});
  const emu::RunResult nf = native_free.take_result(), ns = native_stalled.take_result(),
                       rf = rtl_free.take_result(), rs = rtl_stalled.take_result();

  const GoldenRun golden = run_golden(c.setup, c.steps);
  for (const emu::RunResult* run : {&rf, &rs}) {
    const Compared compared = compare(plan, golden, *run);
    EXPECT_EQ(compared.difference, "");
    EXPECT_EQ(compared.steps, c.steps + 1);
    EXPECT_EQ(compared.particles, (c.steps + 1) * c.setup.initial.particles.size());
    EXPECT_EQ(compared.slots, compared.particles);
  }
  const uint64_t spans = c.steps * plan.nodes() * kPhases;
  for (const auto& [a, b] : {std::pair{&nf, &rf}, std::pair{&ns, &rs}}) {
    const Compared compared = compare_cycles(*a, *b);
    EXPECT_EQ(compared.difference, "");
    EXPECT_EQ(compared.spans, spans);
  }
  EXPECT_FALSE(rf.trace.cycles == rs.trace.cycles);
  // Where no link stalls, nodes that stand still are left out.
  const double all = static_cast<double>(plan.nodes()) * counter_of(rf, "cycles");
  EXPECT_GT(counter_of(rf, "node_calls"), 0);
  EXPECT_LT(counter_of(rf, "node_calls"), all);
  EXPECT_EQ(counter_of(rs, "node_calls"), static_cast<double>(plan.nodes()) * counter_of(rs, "cycles"));
  // What the RTL's force engines did: each count is the native nodes'.
  for (const auto& [a, b] : {std::pair{&nf, &rf}, std::pair{&ns, &rs}})
    for (const char* name :
         {"candidates", "pairs_issued", "queue_stalls", "issue_cycles", "force_cycles", "link_beats"}) {
      EXPECT_EQ(counter_of(*a, name), counter_of(*b, name)) << name;
      if (std::string(name) != "queue_stalls") {
        EXPECT_GT(counter_of(*b, name), 0) << name;
      }
    }
}

TEST_P(Rtl, EqualsGoldenInBitsAndTheNativeNodeInCycles) { expect_golden(make_case(GetParam())); }

INSTANTIATE_TEST_SUITE_P(Cases, Rtl, testing::ValuesIn(rtl_cases()), [](const auto& p) { return p.param; });

// Thin and thick ones, ragged ones, a node that is its own neighbour, flat ones, several lanes and pipes,
// serial and shared multipliers.
INSTANTIATE_TEST_SUITE_P(Bricks, Rtl,
                         testing::Values("undamped_2x2x2.brick_2x1x1", "hot_gas.brick_2x2x2",
                                         "rich_ring.brick_3x1x2", "rich_force_held.brick_2x2x1",
                                         "flat_ring.brick_2x2x1", "periodic_27.brick_2x3x2", "brick_serial",
                                         "brick_shared"),
                         [](const auto& p) { return p.param.substr(0, p.param.find('.')); });

class RtlFaults : public testing::TestWithParam<Fault> {};

void expect_as_in_golden(const Case& c, Fault fault) {
  const Plan& plan = c.setup.plan;
  const GoldenRun golden = run_golden(c.setup, c.steps);
  for (const double rate : {0.0, 0.4}) {
    const auto options = keep_all(c.steps, rate);
    const auto rtl = run_loop_bench(plan, c.setup.initial, options, verilated_nodes(plan), "rtl");
    const auto native = run_loop_bench(plan, c.setup.initial, options, emu::native_nodes(plan), "plain");
    EXPECT_EQ(compare(plan, golden, rtl).difference, "");
    ASSERT_TRUE(rtl.trace.stop);
    EXPECT_EQ(rtl.trace.stop->fault, fault);
    EXPECT_EQ(rtl.trace.stop->number, golden.fault->number);
    EXPECT_EQ(compare_cycles(native, rtl).difference, "");
  }
}

TEST_P(RtlFaults, ArisesAsInGolden) { expect_as_in_golden(fault_case(GetParam()), GetParam()); }

TEST_P(RtlFaults, ArisesInNarrowNodesToo) {
  expect_as_in_golden(with_narrow_memories(fault_case(GetParam())), GetParam());
}

// In pipe, update, on the way out, on arrival; the cell of the brick is told as SystemC's node tells it.
class RtlBrickFaults : public testing::TestWithParam<Fault> {};

TEST_P(RtlBrickFaults, AriseAsInGolden) {
  const Case c = fault_case(GetParam());
  expect_as_in_golden(with_brick(c, bricks_for(c.setup.plan.lattice).back()), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Kinds, RtlBrickFaults, testing::ValuesIn(all_faults()),
                         [](const auto& p) { return "fault_" + std::to_string(static_cast<int>(p.param)); });

class RtlArrivalFaults : public testing::TestWithParam<Fault> {};

TEST_P(RtlArrivalFaults, AriseAsInGolden) {
  expect_as_in_golden(with_halos_on_arrival(fault_case(GetParam())), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Kinds, RtlArrivalFaults, testing::ValuesIn(all_faults()),
                         [](const auto& p) { return "fault_" + std::to_string(static_cast<int>(p.param)); });

INSTANTIATE_TEST_SUITE_P(Kinds, RtlFaults, testing::ValuesIn(all_faults()),
                         [](const auto& p) { return "fault_" + std::to_string(static_cast<int>(p.param)); });

// Against a golden run whose table has one more in every word, the hardware's run is seen to differ.
TEST(RtlMutation, AnotherTableIsSeen) {
  const Case c = make_case("undamped_2x2x2");
  Case other = c;
  for (int32_t& word : other.setup.plan.rule.force.c0) word += 1;
  const auto run =
      run_loop_bench(c.setup.plan, c.setup.initial, keep_all(c.steps), verilated_nodes(c.setup.plan), "rtl");
  EXPECT_EQ(compare(c.setup.plan, run_golden(c.setup, c.steps), run).difference, "");
  EXPECT_EQ(compare(c.setup.plan, run_golden(other.setup, c.steps), run).difference.substr(0, 17),
            "step 1: particle ");
}

// A node that hears zeros without end from below x, from cycle 11 of the run on: records of whichever stream
// is open then.
class Flooded : public emu::NodeModel {
 public:
  explicit Flooded(std::unique_ptr<emu::NodeModel> inner) : inner_(std::move(inner)) {}
  void clock(const emu::NodeInputs& in, emu::NodeOutputs& out) override {
    emu::NodeInputs changed = in;
    if (in.control->start)
      since_ = 0;
    else if (since_ >= 0)
      ++since_;
    if (since_ > 10) {
      changed.valid |= 1;
      changed.beat[0] = &beat_;
    }
    inner_->clock(changed, out);
  }

 private:
  std::unique_ptr<emu::NodeModel> inner_;
  const emu::Beat beat_;
  int since_ = -1;
};

emu::NodeFactory one_flooded(const Plan& plan) {
  return [inner = verilated_nodes(plan)](uint32_t node, uint8_t has_link) {
    std::unique_ptr<emu::NodeModel> model = inner(node, has_link);
    if (node == 1) model = std::make_unique<Flooded>(std::move(model));
    return model;
  };
}

// "cuboct_halos.sv:LINE" of the assertion of that name.
std::string place_of(const std::string& assertion) {
  std::ifstream source(CUBOCT_SOURCE_DIR "/rtl/lib/memories/cuboct_halos.sv");
  int number = 1;
  for (std::string line; std::getline(source, line); ++number)
    if (line.find(assertion + ": assert") != std::string::npos)
      return fmt::format("cuboct_halos.sv:{}", number);
  ADD_FAILURE() << "no assertion " << assertion;
  return "";
}

// The assertions that a node's memories have room: the run ends, the process does not.
TEST(RtlAssertion, EndsThePlainRunWithNodeCycleAndLine) {
  const Case c = make_case("undamped_2x2x2");
  EXPECT_EQ(
      refused_with<std::runtime_error>([&] {
        run_loop_bench(c.setup.plan, c.setup.initial, keep_all(5), one_flooded(c.setup.plan), "rtl");
      }),
      "node 1 (1,0,0), cycle 60: the assertion of the RTL at " + place_of("a_migrate_room") + " failed");
}

TEST(RtlAssertion, EndsTheProgramWithOne) {
  const std::string scene = CUBOCT_SOURCE_DIR "/scenes/lj_block.toml",
                    out = testing::TempDir() + "assertion.h5";
  std::vector<std::string> words{"cuboct-rtl", scene, "--steps", "2", "--out", out};
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  testing::internal::CaptureStderr();
  const int code =
      emu::run_machine(static_cast<int>(argv.size()), argv.data(),
                       {.name = "cuboct-rtl", .description = "", .engine = "rtl", .nodes = one_flooded});
  EXPECT_EQ(code, 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "cuboct-rtl: node 1 (1,0,0), cycle 17: the assertion of the RTL at " + place_of("a_halo_room") +
                " failed\n");
}

// The emitted lattice as one SystemC module: its wiring is the generator's, not the bench's.
emu::RunResult run_lattice(const Case& c) {
  const Plan& plan = c.setup.plan;
  const emu::Library library(emu::compile_lattice(plan, c.setup.initial, kCache, kOptimise));
  void* model = library.create(5);
  const auto particles = emu::by_node(plan, c.setup.initial);
  const uint32_t nodes = plan.nodes();
  emu::Collector collector(plan, keep_all(c.steps));
  std::vector<CuboctOut> outs(nodes);
  CuboctIn host{};
  const auto clock = [&](uint32_t load_node) {
    EXPECT_STREQ(library.clock_lattice(model, &host, load_node, outs.data()), nullptr);
  };
  clock(0);
  host.reset_n = 1;
  host.load_valid = 1;
  for (uint32_t n = 0; n < nodes; ++n)
    for (const emu::Loaded& loaded : particles[n]) {
      host.load_data = loaded.word.word.data();
      host.load_cell = loaded.cell;
      clock(n);
    }
  host.load_valid = 0;
  host.start = 1;
  host.steps = static_cast<uint32_t>(c.steps);
  clock(0);
  host.start = 0;
  emu::NodeOutputs shown;
  for (uint64_t cycle = 0; !collector.done() && cycle < 1000000; ++cycle) {
    clock(0);
    for (uint32_t n = 0; n < nodes; ++n) {
      emu::read_outputs(outs[n], shown);
      if (emu::Collector::shows(shown)) collector.collect(n, cycle, shown);
    }
  }
  library.destroy(model);
  emu::RunResult result;
  EXPECT_TRUE(collector.done());
  if (!collector.done()) return result;
  result.trace = collector.take_trace();
  result.order = collector.order();
  result.trace.engine = "lattice";
  return result;
}

class RtlLattice : public testing::TestWithParam<std::string> {};

void expect_equal_to_wired_nodes(const Case& c) {
  const Plan& plan = c.setup.plan;
  const emu::RunResult whole = run_lattice(c);
  const Compared with_golden = compare(plan, run_golden(c.setup, c.steps), whole);
  EXPECT_EQ(with_golden.difference, "");
  EXPECT_EQ(with_golden.steps, c.steps + 1);
  const auto wired = run_loop_bench(plan, c.setup.initial, keep_all(c.steps), verilated_nodes(plan), "rtl");
  const Compared with_wired = compare_cycles(wired, whole);
  EXPECT_EQ(with_wired.difference, "");
  EXPECT_EQ(with_wired.spans, c.steps * plan.nodes() * kPhases);
}

TEST_P(RtlLattice, EqualsTheWiredNodes) { expect_equal_to_wired_nodes(make_case(GetParam())); }

TEST(RtlBrickLattice, EqualsTheWiredNodes) {
  expect_equal_to_wired_nodes(make_case("lattice_3x2x1.brick_2x1x1"));
}

INSTANTIATE_TEST_SUITE_P(Cases, RtlLattice,
                         testing::Values("undamped_2x2x2", "lattice_3x2x1", "flat.snug", "flat_narrow"),
                         [](const auto& p) { return p.param.substr(0, p.param.find('.')); });

}  // namespace
}  // namespace cuboct::test
