// SPDX-License-Identifier: MIT
// Checked links of the emitted nodes: golden's bits, the native node's cycles, with and without faults, in
// the plain loop and behind SystemC. One test per process.
#include <gtest/gtest.h>

#include <systemc>

#include "emu/machine/bench.h"
#include "emu/systemc/node.h"
#include "emu/verilated/verilated_node.h"
#include "tests/backend/engines.h"
#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

constexpr const char* kCache = CUBOCT_TEST_CACHE;

bool equal(const emu::FaultCounts& a, const emu::FaultCounts& b) {
  return a.flips == b.flips && a.drops == b.drops && a.repeats == b.repeats && a.acks == b.acks &&
         a.detected == b.detected && a.healed == b.healed;
}

class LinkRtl : public testing::TestWithParam<std::string> {};

// Two native lattices and two of emitted nodes, each behind SystemC, with stalls in one pair.
TEST_P(LinkRtl, EqualsGoldenInBitsAndTheNativeNodeInCycles) {
  const Case c = make_case(GetParam());
  const Plan& plan = c.setup.plan;
  const emu::NodeFactory native = emu::native_nodes(plan),
                         verilated = emu::verilated_nodes(plan, kCache, 17, "-O0");
  const auto free = keep_all(c.steps), stalled = keep_all(c.steps, 0.3, 7);
  emu::Bench nf("native_free", plan, c.setup.initial, free, native, "systemc");
  emu::Bench ns("native_stalled", plan, c.setup.initial, stalled, native, "systemc");
  emu::Bench rf("rtl_free", plan, c.setup.initial, free, verilated, "rtl");
  emu::Bench rs("rtl_stalled", plan, c.setup.initial, stalled, verilated, "rtl");
  emu::simulate({&nf, &ns, &rf, &rs});
  const GoldenRun golden = run_golden(c.setup, c.steps);
  for (const auto& [a, b] : {std::pair{&nf, &rf}, std::pair{&ns, &rs}}) {
    const emu::RunResult systemc = a->take_result(), rtl = b->take_result();
    EXPECT_EQ(compare(plan, golden, systemc).difference, "");
    EXPECT_EQ(compare(plan, golden, rtl).difference, "");
    const Compared cycles = compare_cycles(systemc, rtl);
    EXPECT_EQ(cycles.difference, "");
    EXPECT_EQ(cycles.spans, c.steps * plan.lattice.size() * kPhases);
  }
}

// The same faults meet both, and both spend the same cycles on them: behind SystemC and in the plain loop.
TEST_P(LinkRtl, MeetsFaultsAsTheNativeNodeDoes) {
  const Case c = make_case(GetParam());
  const Plan& plan = c.setup.plan;
  emu::RunOptions options = keep_all(c.steps, 0.1, 3);
  if (plan.link.check == LinkCheck::retry)
    options.faults.rate = 0.02;
  else
    options.faults.count = 1;
  const emu::NodeFactory native = emu::native_nodes(plan),
                         verilated = emu::verilated_nodes(plan, kCache, 5, "-O0");
  emu::Bench systemc("native", plan, c.setup.initial, options, native, "systemc");
  emu::Bench rtl("rtl", plan, c.setup.initial, options, verilated, "rtl");
  emu::simulate({&systemc, &rtl});
  const emu::RunResult plain = run_loop_bench(plan, c.setup.initial, options, native, "plain"),
                       s = systemc.take_result(), r = rtl.take_result();
  EXPECT_EQ(compare_cycles(plain, s).difference, "");
  EXPECT_EQ(compare_cycles(s, r).difference, "");
  EXPECT_TRUE(equal(plain.faults, s.faults));
  EXPECT_TRUE(equal(s.faults, r.faults));
  EXPECT_EQ(r.faults.detected, r.faults.injected());
  if (plan.link.check == LinkCheck::retry) {
    EXPECT_GT(r.faults.injected(), 50u);
    EXPECT_EQ(r.faults.healed, r.faults.injected());
    EXPECT_EQ(compare(plan, run_golden(c.setup, c.steps), r).difference, "");
  } else {
    ASSERT_TRUE(r.trace.stop);
    EXPECT_TRUE(is_of_link(r.trace.stop->fault));
  }
}

// Native and emitted nodes as neighbours: every beat and acknowledgement of the one is opened by the other,
// so that the checks are equal bit by bit.
TEST_P(LinkRtl, SpeaksTheNativeNodesCode) {
  const Case c = make_case(GetParam());
  const Plan& plan = c.setup.plan;
  const emu::NodeFactory native = emu::native_nodes(plan),
                         verilated = emu::verilated_nodes(plan, kCache, 0, "-O0");
  const emu::NodeFactory mixed = [&](uint32_t node, uint8_t has_link) {
    const Cell& cell = plan.lattice.cell(node);
    return (cell[0] + cell[1] + cell[2]) % 2 != 0 ? verilated(node, has_link) : native(node, has_link);
  };
  const emu::RunResult got = run_loop_bench(plan, c.setup.initial, keep_all(c.steps), mixed, "mixed");
  EXPECT_EQ(compare(plan, run_golden(c.setup, c.steps), got).difference, "");
}

INSTANTIATE_TEST_SUITE_P(Cases, LinkRtl, testing::Values("undamped_2x2x2.detect", "flat_ring.retry"),
                         [](const auto& p) {
                           std::string name = p.param;
                           name[name.find('.')] = '_';
                           return name;
                         });

}  // namespace
}  // namespace cuboct::test

int main(int argc, char** argv) { return sc_core::sc_elab_and_sim(argc, argv); }
