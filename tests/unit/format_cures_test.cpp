// SPDX-License-Identifier: MIT
// What a refusal of formats, widths or plans hints at is given, and the refusal is gone.
#include "model/contract/format_cures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>

#include "hw/plan/real_plan.h"
#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/contract/quantise.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

const std::string kCuredBar = R"(
density = "1.41 g/cm^3"
[packing]
pitch = "0.5 mm"
[geometry]
shape = "box"
min = "[0, 0, 0] mm"
max = "[6, 1.5, 1.5] mm"
[law]
kind = "elastic"
youngs_modulus = "3 GPa"
direction = [1, 0, 0]
)";
const std::string kAtItsEnd =
    "region = { shape = \"half_space\", point = \"[0.1, 0, 0] mm\", normal = \"x\" }\n";
const std::string kForTwoSteps = "[run]\nsteps = 2\n";

std::string moved_at(const std::string& velocity) {
  return kCuredBar + "[[constraint]]\nname = \"end\"\nkind = \"moved\"\nvelocity = \"" + velocity + "\"\n" +
         kAtItsEnd;
}

// What is said against a machine for the scene.
std::string refused_as(const std::string& scene, const Arch& arch = {}) {
  return refused_with([&] { plan_of(parse_scene(scene, "scene.toml"), arch); });
}

// The parts of the hint that the pattern has in brackets.
std::vector<std::string> hint_in(const std::string& said, const std::string& pattern) {
  std::smatch found;
  if (!std::regex_search(said, found, std::regex("\n  hint: " + pattern + "$"))) {
    ADD_FAILURE() << "not hinted at: " << pattern << "\n" << said;
    return std::vector<std::string>(4, "1");
  }
  return {found.begin() + 1, found.end()};
}

TEST(FormatCures, ADtThatHolds) {
  const std::string fast = moved_at("[9e5, 0, 0] m/s");
  const std::string dt =
      hint_in(refused_as(fast + kForTwoSteps), "a dt of at most ([0-9.e-]+) s holds it")[0];
  EXPECT_EQ(refused_as(fast + fmt::format("[run]\ndt = \"{} s\"\nsteps = 2\n", dt)), "accepted");
  // And not by far less than need be.
  EXPECT_NE(refused_as(fast + fmt::format("[run]\ndt = \"{} s\"\nsteps = 2\n", 1.02 * std::stod(dt))),
            "accepted");
}

TEST(FormatCures, GuardBitsThatKeepWhatIsSlow) {
  for (const std::string& scene : {moved_at("[1e-9, 0, 0] m/s") + kForTwoSteps,
                                   "gravity = \"[0, 0, -5e-2] m/s^2\"\n" + kCuredBar + kForTwoSteps}) {
    Arch arch;
    arch.widths.guard =
        std::stoi(hint_in(refused_as(scene), "guard = ([0-9]+) in the arch file keeps it")[0]);
    EXPECT_EQ(refused_as(scene, arch), "accepted");
    arch.widths.guard -= 2;
    EXPECT_NE(refused_as(scene, arch), "accepted");
  }
}

TEST(FormatCures, DoublesHoldWhatNoIntegersDo) {
  for (const std::string& scene :
       {moved_at("[1e-12, 0, 0] m/s") + kForTwoSteps,
        kCuredBar + "[[material]]\nname = \"rest\"\n[[material]]\nname = \"soft\"\nstrength = 1e-5\n" +
            kAtItsEnd + kForTwoSteps}) {
    hint_in(refused_as(scene), R"(doubles hold any \(--engine reference\))");
    const Scene read = parse_scene(scene, "scene.toml");
    EXPECT_FALSE(formats_hold(read, Arch{}));
    const Plan plan = real_plan_of(read, Arch{});
    EXPECT_EQ(plan.particles, read.body.size());
    EXPECT_EQ(plan.rule.cell_edge, read.rule.cutoff());
  }
}

// A controller on three materials, the heaviest of 900 times the mass of the lightest.
TEST(FormatCures, GainsForTheHeavyMaterial) {
  const auto scene = [](const std::string& more) {
    return R"(density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[geometry]
shape = "box"
size = "[4, 3, 3] mm"
[regions]
low = { shape = "half_space", point = "[0, 0, 0.1] mm", normal = "-z" }
side = { shape = "half_space", point = "[0, 1.3, 0] mm", normal = "-y" }
[law]
kind = "elastic"
stiffness = "1 kN/m"
[[material]]
name = "a"
mass = "1 mg"
[[material]]
name = "b"
mass = "900 mg"
region = "low"
[[constraint]]
name = "q"
kind = "moved_by_force"
velocity = "[0, 0, 5] m/s"
kd = "0.3 kg/s"
kp = "25 kN/m"
region = "side"
)" + more + kForTwoSteps;
  };
  const auto gains =
      hint_in(refused_as(scene("")),
              R"(a constraint of its own with kp = ([0-9.e+]+) N/m, or more, for 'b/q' holds it; )"
              R"(doubles hold any \(--engine reference\))");
  const auto own = [&](double kp, double kd) {
    return scene(fmt::format(R"([[constraint]]
name = "heavy"
kind = "moved_by_force"
velocity = "[0, 0, 5] m/s"
kp = "{} N/m"
kd = "{} kg/s"
region = {{ shape = "intersection", of = ["low", "side"] }}
)",
                             kp, kd));
  };
  const double kp = std::stod(gains[0]), kd = 0.3;
  EXPECT_EQ(refused_as(own(kp, kd)), "accepted");
  EXPECT_NE(refused_as(own(kp / 100, kd)), "accepted");
}

TEST(FormatCures, WidthsForKicks) {
  // A steep core, and a heavy particle, for which velocities are fine.
  const std::string scene = R"(units = "reduced"
mass = 1.0
[law]
kind = "lj"
epsilon = 1.0
sigma = 1.0
cutoff = 2.5
core = 0.3
[[particle]]
position = [0, 0, 0]
[[particle]]
position = [1.1, 0, 0]
[[material]]
name = "l"
mass = 1.0
[[material]]
name = "m"
mass = 900.0
region = { shape = "half_space", point = [0.5, 0, 0], normal = [1, 0, 0] }
[run]
dt = 0.0001
steps = 2
)";
  Arch guard;
  guard.widths.guard = std::stoi(hint_in(refused_as(scene), "guard = ([0-9]+) in the arch file holds it")[0]);
  EXPECT_EQ(refused_as(scene, guard), "accepted");
  // Velocities that are too fine for a table of 18 bits.
  const Scene bar = parse_scene(moved_at("[1, 0, 0] m/s") + kForTwoSteps, "scene.toml");
  const double edge = cell_edges_of(bar, Arch{}, CellForm::cubes).longest;
  const auto said = [&](const Widths& widths) -> std::string {
    return refused_with([&] { quantise(bar.rule, edge, widths, {}); });
  };
  Widths fine;
  fine.guard = 26;
  fine.velocity_bits = fine.sum_bits = 47;
  fine.strength_bits = 18;
  const auto either =
      hint_in(said(fine), "strength_bits = ([0-9]+) or guard = ([0-9]+) in the arch file holds it");
  Widths wider = fine, coarser = fine;
  wider.strength_bits = std::stoi(either[0]);
  EXPECT_EQ(said(wider), "accepted");
  coarser.guard = std::stoi(either[1]);
  coarser.velocity_bits = coarser.velocity_frac() + 1;
  EXPECT_EQ(said(coarser), "accepted");
}

TEST(FormatCures, DampingThatFits) {
  const auto damped = [](double coefficient) {
    return kCuredBar + fmt::format("[damping]\ncoefficient = \"{} kg/s\"\n", coefficient) + kForTwoSteps;
  };
  Arch arch;
  const auto wider = hint_in(
      refused_as(damped(100)),
      "relative_velocity_frac = ([0-9]+), relative_velocity_bits = ([0-9]+) in the arch file hold it");
  arch.widths.relative_velocity_frac = std::stoi(wider[0]);
  arch.widths.relative_velocity_bits = std::stoi(wider[1]);
  EXPECT_EQ(refused_as(damped(100), arch), "accepted");
  const auto share = hint_in(refused_as(damped(1e6)), "damping of at most ([0-9.e-]+) of this holds it");
  EXPECT_EQ(refused_as(damped(1e6 * std::stod(share[0]))), "accepted");
}

TEST(FormatCures, EntriesForOctaves) {
  Arch arch;
  arch.table.shape = TableChoice::Shape::octaves;
  arch.table.index_bits = 2;
  const auto bits = hint_in(refused_as(kCuredBar + kForTwoSteps, arch),
                            "index_bits = ([0-9]+), or shape = \"uniform\", in the arch file's \\[table\\]");
  arch.table.index_bits = std::stoi(bits[0]);
  EXPECT_EQ(refused_as(kCuredBar + kForTwoSteps, arch), "accepted");
  arch.table = {.shape = TableChoice::Shape::uniform, .index_bits = 2};
  EXPECT_EQ(refused_as(kCuredBar + kForTwoSteps, arch), "accepted");
}

// A cell that holds the whole bar has more particles than a node.
TEST(FormatCures, ACapacityThatANodeCanHave) {
  Arch arch;
  arch.cell_edge = 2e-2;
  hint_in(refused_as(std::regex_replace(kCuredBar, std::regex("0.5 mm"), "0.35 mm") + kForTwoSteps, arch),
          "a cell holds at most 256: a shorter node.cell_edge");
  arch.cell_edge = 1.5e-3;
  EXPECT_EQ(refused_as(kCuredBar + kForTwoSteps, arch), "accepted");
  arch.capacity = 4;
  arch.capacity = std::stoi(hint_in(refused_as(kCuredBar + kForTwoSteps, arch),
                                    "set node.capacity to at least ([0-9]+) in the arch file")[0]);
  EXPECT_EQ(refused_as(kCuredBar + kForTwoSteps, arch), "accepted");
}

// Machines whose parts do not go together: what is asked for is set, one after the other.
TEST(FormatCures, PartsThatGoTogether) {
  const auto settle = [](std::string node) {
    int hints = 0;
    for (; hints < 8; ++hints) {
      const std::string said =
          refused_as(kCuredBar + kForTwoSteps, parse_arch("name = \"a\"\n[node]\n" + node, "arch.toml"));
      std::smatch set;
      if (said == "accepted") break;
      if (!std::regex_search(
              said, set,
              std::regex("set (node\\.)?([a-z_]+) (?:= |to at most )([^\n]*?)( in the arch file)?(\n|$)"))) {
        ADD_FAILURE() << said;
        break;
      }
      const std::string key = set[2];
      node = std::regex_replace(node, std::regex("(^|\n)" + key + " = [^\n]*\n"), "$1") + key + " = " +
             set[3].str() + "\n";
    }
    return hints;
  };
  EXPECT_EQ(settle("memories = \"narrow\"\nbrick = [2, 1, 1]\n"), 3);
  EXPECT_EQ(settle("halos = \"arrival\"\noverlap = false\nbrick = [2, 1, 1]\n"), 2);
  EXPECT_EQ(settle("brick = [99, 1, 1]\n"), 1);
}

}  // namespace
}  // namespace cuboct
