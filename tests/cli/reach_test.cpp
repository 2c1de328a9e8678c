// SPDX-License-Identifier: MIT
// Cells for what the motion asks for, as a user meets them: [reach] margin = "auto", what `check` says of it
// and of a margin that is too wide, word for word.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

// The template's block, four times as coarse, from 5 cm onto its floor.
std::string dropped(const Bench& bench, const std::string& margin, const std::string& duration = "300 ms") {
  const std::string path = bench.path("block.toml");
  std::ofstream(path) << R"(title = "A fall"
density = "1 g/cm^3"
gravity = "[0, 0, -9.81] m/s^2"
[packing]
pitch = "2 mm"
[geometry]
shape = "union"
of = ["block", "floor"]
[regions]
block = { shape = "box", min = "[-3, -3, 50] mm", max = "[3, 3, 56] mm" }
floor = { shape = "box", min = "[-5, -5, -2] mm", max = "[5, 5, 0] mm" }
[law]
kind = "brittle"
youngs_modulus = "1 MPa"
direction = "z"
[damping]
ratio = 0.02
[[material]]
name = "rubber"
[[material]]
name = "ground"
region = "floor"
[[bond]]
between = ["rubber", "ground"]
contact = true
[[constraint]]
name = "fixed"
kind = "held"
region = "floor"
[[probe]]
name = "block"
kind = "velocity"
region = "block"
axis = "z"
[run]
dt = "auto"
duration = ")" << duration
                      << "\"\n[reach]\nmargin = " << margin << "\n";
  return path;
}

constexpr const char* kWide =
    "133308 cells are built, and 42 hold matter at the start. With one cell edge, 2.83 mm, for "
    "reach.margin they are 17388 along x, 17388 along y, 16473 along z. The motion of the scene asks for "
    "1600 of "
    "them: set margin = \"auto\", or margin = \"[6.9, 6.9, 54] mm\" for 4779";

std::string line_of(const std::string& text, const std::string& start) {
  const size_t from = text.find("\n" + start);
  return from == std::string::npos ? "" : text.substr(from + 1, text.find('\n', from + 1) - from - 1);
}

TEST(Reach, CheckSaysWhatAWideMarginCosts) {
  const Bench bench(false);
  const Answer answer = bench.cuboct({"check", dropped(bench, "\"60 mm\"")});
  EXPECT_EQ(line_of(answer.out, "warning"), std::string("warning: ") + kWide);
  const nlohmann::json json =
      nlohmann::json::parse(bench.cuboct({"check", dropped(bench, "\"60 mm\""), "--json"}).out);
  EXPECT_EQ(json["warnings"]["value"][0]["text"], kWide);
  EXPECT_EQ(json["cells_with_matter"]["value"], 42);
  // One that suits the motion costs nothing worth a word.
  EXPECT_EQ(line_of(bench.cuboct({"check", dropped(bench, "\"[4, 4, 60] mm\"")}).out, "warning"), "");
}

// A margin in lengths around every particle would ask for more cells than can be built: it is left unsaid.
TEST(Reach, CheckLeavesOutWhatCannotBeBuilt) {
  const Bench bench(false);
  const std::string path = bench.path("plate.toml");
  std::ofstream(path) << R"(title = "A block that flies past a plate"
density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[geometry]
shape = "union"
of = ["plate", "block"]
[regions]
plate = { shape = "box", min = "[-2, -50, -50] mm", max = "[0, 50, 50] mm" }
block = { shape = "box", min = "[10, -1.5, -1.5] mm", max = "[13, 1.5, 1.5] mm" }
[law]
kind = "brittle"
youngs_modulus = "1 MPa"
direction = "z"
[[constraint]]
name = "fixed"
kind = "held"
region = "plate"
[[velocity]]
region = "block"
uniform = "[5, 0, 0] m/s"
[run]
dt = "auto"
duration = "900 ms"
[reach]
min = "[-10, -51.9, -51.9] mm"
max = "[4520, 51.9, 51.9] mm"
)";
  const Answer answer = bench.cuboct({"check", path});
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(
      line_of(answer.out, "warning"),
      "warning: 17.5 million cells are built, and 10108 hold matter at the start. Without reach.min and "
      "reach.max they are 21441. The motion of the scene asks for 100991 of them: set margin = \"auto\"");
}

TEST(Reach, AutomaticFollowsTheMotion) {
  const Bench bench(false);
  const std::string path = dropped(bench, "\"auto\"");
  EXPECT_EQ(line_of(bench.cuboct({"check", path}).out, "reach"),
            "reach            2.83 mm around each particle, a cell edge; of 'rubber' x 4.02 mm, y 4.02 mm, "
            "-z 50.9 mm to "
            "'ground', +z 5.74 mm more, by gravity, an impact");
  EXPECT_EQ(nlohmann::json::parse(bench.cuboct({"check", path, "--json"}).out)["nodes"]["value"], 1600);
  // It falls, bounces, and the run ends. It strikes at sqrt(2 g h).
  const Answer ran = bench.cuboct({"run", path, "--quiet", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.out << ran.err;
  const nlohmann::json summary = nlohmann::json::parse(ran.out);
  EXPECT_EQ(summary["ended"]["value"], "finished");
  EXPECT_NEAR(summary["block.velocity"]["smallest"], -0.98, 0.02);
  EXPECT_GT(summary["block.velocity"]["largest"], 0.5);
}

TEST(Reach, ARuleThatMovesNothingNeedsTheCellsOfItsMatter) {
  const Bench bench(false);
  const Answer told = bench.cuboct(
      {"check", "scenes/boards/heat.toml", "--arch", "scenes/archs/icebreaker_heat.toml", "--machine"});
  EXPECT_NE(told.out.find("the cells with matter: no particle moves"), std::string::npos) << told.out;
  EXPECT_NE(told.out.find("1 node of 24 slots of 103 bits"), std::string::npos) << told.out;
}

// A pair that begins pressed together: its stored energy is no motion.
TEST(Reach, AFaultSaysThatItWasNotForeseen) {
  const Bench bench(false);
  const std::string path = bench.path("pressed.toml");
  std::ofstream(path)
      << "title = \"Pressed\"\nunits = \"reduced\"\nmass = 1.0\n"
         "[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n"
         "[[particle]]\nposition = [0.0, 0.0, 0.0]\n[[particle]]\nposition = [0.85, 0.0, 0.0]\n"
         "[run]\ndt = 0.001\nsteps = 3000\n[reach]\nmargin = \"auto\"\n";
  const Answer answer = bench.cuboct({"run", path, "--quiet"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(
      line_of(answer.out, "advice"),
      "advice            cell (-1 0 0) at (-1.875, 0.625, 1.25) m: particle 0 went where no cell is; "
      "reach.margin = \"auto\" did not foresee it: give reach.margin in lengths, or reach.min and reach.max "
      "beside it");
}

TEST(Reach, OtherWordsAreRefused) {
  const Bench bench(false);
  const auto refusal = [&](const std::string& text) {
    const std::string path = bench.path("word.toml");
    std::ofstream(path) << text;
    const Answer answer = bench.cuboct({"check", path});
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    return without_excerpt(answer.err).substr(path.size());
  };
  const std::string rest =
      "units = \"reduced\"\nmass = 1.0\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n"
      "[[particle]]\nposition = [0, 0, 0]\n[run]\ndt = 0.001\nsteps = 1\n";
  EXPECT_EQ(refusal("reach = \"auto\"\n" + rest),
            ":1:9: 'reach' must be a table\n"
            "  hint: for the cells that the motion asks for write margin = \"auto\" in [reach]\n");
  EXPECT_EQ(refusal(rest + "[reach]\nmargin = \"automatic\"\n"),
            ":14:10: unknown margin 'automatic'\n  hint: \"auto\", one length or three\n");
}

}  // namespace
}  // namespace cuboct::test
