// SPDX-License-Identifier: MIT
// Rules of text on the clocked nodes: golden's bits, order and faults, and the timing model's cycles.
#include <fmt/format.h>
#include <gtest/gtest.h>


#include "emu/systemc/node.h"
#include "hw/engine/engine_kind.h"
#include "hw/plan/setup.h"
#include "model/program/integer_program.h"
#include "model/run/integer_run.h"
#include "tests/backend/clocked_timing.h"
#include "tests/backend/engines.h"
#include "tests/support/dice.h"

namespace cuboct::test {
namespace {

// A hot packing in a periodic box: in each step some particles leave their cell.
std::string hot(const std::string& rule, const std::string& more = "") {
  return "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\" }\nrun = { dt = \"0.2 us\", steps = 9 }\n"
         "[box]\nperiodic = \"xyz\"\ncells = [4, 3, 3]\n[[velocity]]\nthermal_speed = \"300 m/s\"\nseed = 3\n" +
         more + "[rule]\n" + rule;
}

// Of each kind of input and of rounds one: a vector and a number that later rounds read of the other, a field
// that goes on from step to step, one round that reads nothing of the other and so sends nothing, velocities
// and noise.
const std::string kFourRounds = R"toml(reach = "1.3 * pitch"
[rule.particle.crowd]
range = [-40, 40]
[rule.particle.way]
kind = "vector"
range = [-40, 40]
[rule.particle.memory]
range = [-1000, 1000]
start = "x.x / pitch"
[[rule.round]]
sum.n = { is = "1 - r / (1.3 * pitch) + noise(7) / 10", when = "r < 1.2 * pitch" }
finish.crowd = "max(min(n, 30), -30)"
[[rule.round]]
sum.w = "(crowd_j - crowd_i) * d / pitch"
finish.way = "[max(min(w.x, 30), -30), max(min(w.y, 30), -30), max(min(w.z, 30), -30)]"
[[rule.round]]
sum.m = "1 - r / (1.3 * pitch)"
finish.memory = "max(min(memory / 2 + m, 900), -900)"
[[rule.round]]
sum.force = "(1 N + 0.1 N * (crowd_i + crowd_j) + 0.01 N * (memory_j + memory_i)) * (r / pitch - 1) * d / r + 0.02 N * (way_j - way_i) - 1e-3 N*s/m * dot(v_i - v_j, d) * d / pitch^2"
)toml";

const std::string kOneRound = R"toml(reach = "1.3 * pitch"
[rule.particle.T]
unit = "K"
range = "[0, 2000] K"
start = "300 K + 100 K * x.x / pitch"
[[rule.round]]
sum.heat = "T_j - T_i"
sum.force = "1 kN/m * (r - pitch) * d / r"
finish.T = "T + heat / 30"
)toml";

Case case_of(const std::string& name, const std::string& text, const Arch& arch, uint64_t steps) {
  Case c;
  c.name = name, c.steps = steps;
  c.scene = parse_scene(text, "rule.toml");
  c.setup.plan = program_plan_of(c.scene, arch, CellForm::cubes);
  const Plan& plan = c.setup.plan;
  c.setup.initial =
      program_beginning(c.scene, {*plan.program, plan.rule, plan.lattice, plan.origin, plan.arch.capacity});
  return c;
}

// Everything that changes cycles alone.
Arch drawn(uint64_t seed) {
  Dice dice(seed);
  Arch arch;
  arch.filter_lanes = dice.chance(50) ? dice.draw(1, 4) : dice.draw(5, 64);
  arch.force_pipes = dice.draw(1, std::min(arch.filter_lanes, 4));
  arch.queue_depth = dice.chance(30) ? 1 : dice.draw(2, 30);
  arch.overlap = dice.chance(70);
  arch.link_bits = dice.chance(30) ? 0 : dice.draw(7, 300);
  arch.link_check = dice.chance(60) || arch.link_bits > 200 || arch.link_bits == 0
                        ? LinkCheck::none
                        : static_cast<LinkCheck>(dice.draw(1, 2));
  if (arch.link_check == LinkCheck::none && dice.chance(30)) {
    arch.boards.nodes = {dice.draw(1, 3), dice.draw(1, 2), dice.draw(1, 3)};
    arch.boards.latency = dice.draw(1, 30), arch.boards.interval = dice.draw(1, 4);
  }
  return arch;
}

class RuleNodes : public testing::TestWithParam<const char*> {
 protected:
  std::string text() const {
    const std::string name = GetParam();
    return name == "one" ? hot(kOneRound) : hot(kFourRounds);
  }
};

TEST_P(RuleNodes, HoldGoldensBitsAndTheModelsCycles) {
  Seen seen;
  uint64_t slots = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const Case c = case_of(fmt::format("{} {}", GetParam(), seed), text(), drawn(seed), 7);
    ASSERT_EQ(difference(c, seen), "") << c.name;
    const auto run = run_loop_bench(c.setup.plan, c.setup.initial, keep_all(c.steps, seed % 2 == 0 ? 0.3 : 0, seed),
                                    emu::native_nodes(c.setup.plan), "plain");
    const Compared compared = compare(c.setup.plan, run_golden(c.setup, c.steps), run);
    EXPECT_EQ(compared.difference, "") << c.name;
    slots += compared.slots;
  }
  EXPECT_EQ(seen.runs, 6u);
  EXPECT_GT(slots, 5000u);
  EXPECT_GT(seen.leave, 50u);
  EXPECT_GT(seen.leave_twice, 3u);
  EXPECT_GT(seen.multi_pass, 0u);
  EXPECT_GT(seen.multi_beat, 0u);
  EXPECT_GT(seen.stalls, 0u);
  EXPECT_GT(seen.boards, 0u);
  EXPECT_GT(seen.checked, 0u);
  EXPECT_GT(seen.no_overlap, 0u);
}
INSTANTIATE_TEST_SUITE_P(Rules, RuleNodes, testing::Values("one", "four"),
                         [](const auto& p) { return std::string(p.param); });

// What later rounds send: what a round reads of the other and nobody sent before, or a finish changed since.
TEST(RuleRecords, HoldWhatTheRoundReadsAnew) {
  const Case c = case_of("four", hot(kFourRounds), {}, 1);
  const graph::FixedProgram& program = c.setup.plan.program->program;
  const auto sent = [&](size_t round) {
    std::vector<std::string> names;
    for (const WordField& field : c.setup.plan.rounds.at(round).record)
      if (field.kind == FieldKind::field) {
        int f = 0;
        while (f + 1 < static_cast<int>(program.fields.size()) && program.place(f + 1) <= field.number) ++f;
        names.push_back(program.fields[static_cast<size_t>(f)].name);
      }
    return names;
  };
  ASSERT_EQ(c.setup.plan.rounds.size(), 4u);
  EXPECT_EQ(sent(0), std::vector<std::string>());
  EXPECT_EQ(sent(1), std::vector<std::string>{"crowd"});
  EXPECT_EQ(sent(2), std::vector<std::string>());
  EXPECT_EQ(c.setup.plan.rounds[2].beats, 0);
  EXPECT_EQ(sent(3), (std::vector<std::string>{"way", "way", "way", "memory"}));
}

// `grows`: in step 5 a field leaves its range in the first round's finish, of those to the right. `pushes`: in the
// same step the last round's push is too strong, of all. What is found in an earlier round counts, though a
// lesser id is found later.
std::string failing(bool grows, bool pushes) {
  return fmt::format(R"toml(reach = "1.3 * pitch"
[rule.particle.a]
range = [-1, 15]
start = "x.x / pitch"
[rule.particle.b]
range = [-1, 15]
[[rule.round]]
sum.n = "1"
finish.a = "{}"
[[rule.round]]
sum.k = "a_j - a_i"
finish.b = "max(min(k / 1000 + b + {}, 8), 0)"
[[rule.round]]
sum.force = "select(b_i > 5, {} N, 1 N) * (r / pitch - 1) * d / r"
)toml",
                     grows ? "a + 1.9" : "a", pushes ? "0.9" : "0", pushes ? "1e7" : "1");
}

TEST(RuleNodeFaults, AreGoldens) {
  uint32_t left = 0, right = 0;  // who is told where one thing fails, and where both do
  for (const auto& [grows, pushes] : {std::pair{true, false}, {false, true}, {true, true}})
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      const Case c = case_of(fmt::format("fails {} {} {}", grows, pushes, seed), hot(failing(grows, pushes)),
                             drawn(seed), 9);
      const GoldenRun golden = run_golden(c.setup, c.steps);
      ASSERT_TRUE(golden.fault) << c.name;
      EXPECT_EQ(golden.fault->step, 5u) << c.name;
      (grows ? right : left) = golden.fault->particle;
      const auto run = run_loop_bench(c.setup.plan, c.setup.initial, keep_all(c.steps, seed == 2 ? 0.2 : 0),
                                      emu::native_nodes(c.setup.plan), "plain");
      EXPECT_EQ(compare(c.setup.plan, golden, run).difference, "") << c.name;
    }
  EXPECT_LT(left, right);
}

}  // namespace
}  // namespace cuboct::test
