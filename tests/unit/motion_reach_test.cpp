// SPDX-License-Identifier: MIT
// What [reach] margin = "auto" tells of small scenes, against closed forms by hand.
#include "model/analysis/motion_reach.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/analysis/motion.h"
#include "model/analysis/shadow.h"

namespace cuboct {
namespace {

// In mm; rows of atoms at whole multiples of 1/sqrt(2) mm along the axes.
const double kLayer = 1e-3 / std::sqrt(2.0);
const std::string kRubber = R"(density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[law]
kind = "brittle"
youngs_modulus = "1 MPa"
direction = "z"
)";

std::string run_for(const std::string& duration) {
  return "[run]\ndt = \"auto\"\nduration = \"" + duration + "\"\n[reach]\nmargin = \"auto\"\n";
}

// A block and a floor below it that only touch.
std::string dropped(const std::string& floor, const std::string& more) {
  return more + kRubber + R"([geometry]
shape = "union"
of = ["block", "floor"]
[regions]
block = { shape = "box", min = "[-2, -2, 20] mm", max = "[2, 2, 24] mm" }
floor = )" +
         floor + R"(
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
)";
}

PieceReach of_material(const Scene& scene, const std::string& name) {
  for (const PieceReach& piece : motion_reach(scene).pieces)
    if (piece.name == name) return piece;
  ADD_FAILURE() << "no piece of " << name;
  return {};
}

Scene scene_of(const std::string& text) { return parse_scene(text, "s.toml"); }

double duration_of_run(const Scene& scene) { return static_cast<double>(scene.steps) * scene.rule.dt; }

void expect_near(const Vec3& found, const Vec3& expected, double tolerance) {
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(found[a], expected[a], tolerance) << "along "
                                                  << "xyz"[a];
}

TEST(Flight, IsAParabola) {
  Flight up({Vec3(0, 0, 10), Vec3(0, 0, 10)}, Vec3(0, 0, -10));
  expect_near(up.until(3).high, Vec3(0, 0, 5), 1e-12);       // v^2/(2 g)
  expect_near(up.until(3).low, Vec3(0, 0, -15), 1e-12);      // v t - g t^2/2
  expect_near(up.until(0.5).high, Vec3(0, 0, 3.75), 1e-12);  // still rising
  expect_near(up.until(0.5).low, Vec3(0, 0, 0), 1e-12);
  // A hit at 2 s, where the place is 0 and the velocity -10, gives it up to 4 along x, and 6 up.
  up.hit(2, {Vec3(0, 0, 0), Vec3(4, 0, 6)});
  expect_near(up.until(3).high, Vec3(4, 0, 5), 1e-12);  // 36/20 from 0 is below the 5 of before
  expect_near(up.until(3).low, Vec3(0, 0, -15), 1e-12);
  expect_near(up.velocity(3).high, Vec3(4, 0, -4), 1e-12);
  up.stop(2, 0, 7, 12);
  expect_near(up.until(3).low, Vec3(0, 0, -7), 1e-12);
  expect_near(up.velocity(3).low, Vec3(0, 0, -12), 1e-12);
}

TEST(Shadow, FallsOnAWallOrBesideIt) {
  // A plate of 5 x 5 at z = 0, two particles above it, one higher.
  std::vector<Vec3> x{Vec3(1, 1, 3), Vec3(2, 1, 3.5)};
  std::vector<uint32_t> wall;
  for (int k = 0; k < 25; ++k) x.emplace_back(k % 5, k / 5, 0), wall.push_back(static_cast<uint32_t>(k + 2));
  const auto on = [&](const Vec3& drift) { return gap_to(x, {0, 1}, wall, 2, 0, drift, 1); };
  ASSERT_TRUE(on(Vec3::Zero()));
  EXPECT_DOUBLE_EQ(on(Vec3::Zero())->least, 3);
  EXPECT_DOUBLE_EQ(on(Vec3::Zero())->most, 3.5);
  EXPECT_TRUE(on(Vec3(2.5, 0, 9)));  // to x = 4.5, within a spacing of the edge
  EXPECT_FALSE(on(Vec3(4, 0, 0)));
  EXPECT_FALSE(gap_to(x, {0, 1}, wall, 2, 1, Vec3::Zero(), 1));  // above them is nothing
  // A hole: the plate without the particles around (1, 1).
  std::erase_if(wall, [&](uint32_t i) { return (x[i] - Vec3(1, 1, 0)).norm() < 1.2; });
  EXPECT_FALSE(on(Vec3::Zero()));
}

TEST(MotionReach, AFallEndsOnAFloorThatIsWideEnough) {
  const std::string gravity = "gravity = \"[0, 0, -9.81] m/s^2\"\n";
  const Scene wide =
      scene_of(dropped(R"({ shape = "box", min = "[-4, -4, -2] mm", max = "[4, 4, 0] mm" })", gravity) +
               run_for("100 ms"));
  const PieceReach block = of_material(wide, "rubber");
  // Layers k of height k/sqrt(2) mm: the lowest of the block is 29, 20.5 mm; the floor ends with 0.
  EXPECT_NEAR(block.beyond.low[2], -29 * kLayer, 1e-9);
  EXPECT_EQ(block.stopped_by[2][0], "ground");
  // It rises no higher than it began, but for the cutoff in which the floor may meet it earlier.
  EXPECT_LT(block.beyond.high[2], 2 * wide.rule.cutoff());
  // A fiftieth of sqrt(2 g h) from the floor on: sqrt(2 h/g) = 64.6 ms, less the cutoff.
  const double speed = std::sqrt(2 * 9.81 * 29 * kLayer),
               falls = std::sqrt(2 * (29 * kLayer - wide.rule.cutoff()) / 9.81);
  EXPECT_NEAR(block.beyond.high[0], 0.02 * speed * (duration_of_run(wide) - falls), 0.02e-3);
  EXPECT_NEAR(block.beyond.low[0], -block.beyond.high[0], 1e-12);
  // The floor has none.
  EXPECT_TRUE(of_material(wide, "ground").beyond.zero());
  // One that is too narrow stops nothing: g T^2/2.
  const Scene narrow =
      scene_of(dropped(R"({ shape = "box", min = "[-4, 0, -2] mm", max = "[4, 4, 0] mm" })", gravity) +
               run_for("100 ms"));
  const PieceReach falls_off = of_material(narrow, "rubber");
  EXPECT_EQ(falls_off.stopped_by[2][0], "");
  EXPECT_LT(falls_off.beyond.low[2], -0.5 * 9.81 * std::pow(duration_of_run(narrow), 2));
  EXPECT_NE(std::ranges::find(falls_off.reasons, "tumbling"), falls_off.reasons.end());
  // Nor does a wide one that it flies past.
  const Scene past =
      scene_of(dropped(R"({ shape = "box", min = "[-4, -4, -2] mm", max = "[4, 4, 0] mm" })", gravity) +
               "[[velocity]]\nregion = \"block\"\nuniform = \"[0.2, 0, 0] m/s\"\n" + run_for("100 ms"));
  EXPECT_EQ(of_material(past, "rubber").stopped_by[2][0], "");
}

TEST(MotionReach, AThrowGoesAsFarAsItsEnergyOrItsTime) {
  const std::string thrown = "gravity = \"[0, 0, -9.81] m/s^2\"\n" + kRubber +
                             "[geometry]\nshape = \"box\"\nsize = \"[3, 3, 3] mm\"\n"
                             "[[velocity]]\nuniform = \"[0.3, 0, 1] m/s\"\n";
  const Scene whole = scene_of(thrown + run_for("300 ms"));
  const PieceReach long_one = motion_reach(whole).pieces.at(0);
  const double t = duration_of_run(whole);
  EXPECT_NEAR(long_one.beyond.high[2], 1 / (2 * 9.81), 1e-9);
  EXPECT_NEAR(long_one.beyond.low[2], t - 0.5 * 9.81 * t * t, 1e-9);
  EXPECT_NEAR(long_one.beyond.high[0], 0.3 * t, 1e-9);
  EXPECT_EQ(long_one.beyond.low[0], 0);
  EXPECT_EQ(fmt::format("{}", fmt::join(long_one.reasons, ", ")), "the initial velocity, gravity");
}

// F/m of all particles together, over the mass of all.
TEST(MotionReach, AForcePulls) {
  const Scene scene = scene_of(kRubber +
                               "[geometry]\nshape = \"box\"\nsize = \"[3, 3, 3] mm\"\n[[constraint]]\nname = "
                               "\"rope\"\nkind = \"pulled\"\nforce = \"[0, 1e-4, 0] N\"\nregion = { shape = "
                               "\"half_space\", point = \"[0, 1, 0] mm\", normal = \"-y\" }\n" +
                               run_for("10 ms"));
  const PieceReach piece = motion_reach(scene).pieces.at(0);
  const double mass = static_cast<double>(scene.body.size()) * scene.rule.mass, t = duration_of_run(scene);
  EXPECT_NEAR(piece.beyond.high[1], 0.5 * 1e-4 / mass * t * t, 1e-9);
  EXPECT_EQ(piece.beyond.low[1], 0);
  EXPECT_EQ(piece.reasons, std::vector<std::string>{"the force"});
}

std::string two_blocks(const std::string& speed) {
  return R"(density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[law]
kind = "brittle"
youngs_modulus = "1 MPa"
direction = "z"
[geometry]
shape = "union"
of = ["left", "right"]
[regions]
left = { shape = "box", min = "[0, 0, 0] mm", max = "[4, 4, 4] mm" }
right = { shape = "box", min = "[8, 0, 0] mm", max = "[12, 4, 4] mm" }
[[material]]
name = "one"
[[material]]
name = "other"
region = "right"
[[velocity]]
region = "left"
uniform = "[)" +
         speed + R"(, 0, 0] m/s"
)";
}

TEST(MotionReach, AnImpactThatBreaksNothingIsElastic) {
  const Scene scene = scene_of(two_blocks("0.5") + run_for("40 ms"));
  const PieceReach struck = of_material(scene, "other"), striker = of_material(scene, "one");
  double left = 0, right = 1;
  size_t of_left = 0;
  for (const Vec3& x : scene.body.x)
    if (x[0] < 6e-3)
      left = std::max(left, x[0]), ++of_left;
    else
      right = std::min(right, x[0]);
  const double t = duration_of_run(scene), meets = (right - left - scene.rule.cutoff()) / 0.5;
  const auto of_one = static_cast<double>(of_left), all = static_cast<double>(scene.body.size());
  EXPECT_NEAR(struck.beyond.high[0], 2 * of_one / all * 0.5 * (t - meets), 1e-6);
  EXPECT_EQ(struck.beyond.low[0], 0);
  EXPECT_NEAR(struck.beyond.high[1], 0.02 * 0.5 * (t - meets), 1e-6);
  // The striker keeps its velocity, or loses up to 2 M/(m + M) of it.
  EXPECT_NEAR(striker.beyond.high[0], 0.5 * t, 1e-9);
  const double back = 0.5 - 2 * (all - of_one) / all * 0.5;
  EXPECT_NEAR(striker.beyond.low[0], std::min(0.0, 0.5 * meets + back * (t - meets)), 1e-6);
}

TEST(MotionReach, FragmentsFlyOn) {
  const std::string text = two_blocks("20");  // of waves at 40 m/s
  const Scene free = scene_of(text + run_for("1 ms"));
  const double t = duration_of_run(free), meets = of_material(free, "other").beyond.high[0] / -50 + t;
  EXPECT_GT(meets, 0);
  EXPECT_LT(meets, 0.2e-3);  // a gap of less than 4 mm
  const PieceReach struck = of_material(free, "other"), striker = of_material(free, "one");
  EXPECT_NEAR(struck.beyond.low[0], -5 * (t - meets), 1e-6);
  EXPECT_NEAR(struck.beyond.high[2], 20 * (t - meets), 1e-6);
  EXPECT_NEAR(striker.beyond.high[0], 20 * t, 1e-6);
  EXPECT_NEAR(striker.beyond.low[0], std::min(0.0, 20 * meets - 5 * (t - meets)), 1e-6);
  // The same of a strip whose end is held.
  const Scene held = scene_of(text +
                              "[[constraint]]\nname = \"rim\"\nkind = \"held\"\nregion = { shape = \"box\", "
                              "min = \"[7, -1, 3] mm\", max = \"[13, 5, 5] mm\" }\n" +
                              run_for("1 ms"));
  const PieceReach strip = of_material(held, "other");
  EXPECT_NEAR(strip.beyond.high[0], struck.beyond.high[0], 1e-9);
  // What holds it does not move.
  const MotionReach reach = motion_reach(held);
  size_t of_rim = 0;
  for (size_t i = 0; i < held.body.size(); ++i) {
    const ParticleType& type = held.rule.types[held.body.type[i]];
    if (type.name != "other/rim") continue;
    ++of_rim;
    EXPECT_TRUE(reach.pieces[reach.piece[i]].of(held.body.x[i], type).zero());
  }
  EXPECT_GT(of_rim, 5u);
}

std::string bar(const std::string& more, const std::string& modulus = "1 MPa") {
  return more + R"(density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[law]
kind = "elastic"
youngs_modulus = ")" +
         modulus + R"("
direction = "x"
[geometry]
shape = "box"
min = "[-1, -2, -2] mm"
max = "[20, 2, 2] mm"
[[constraint]]
name = "clamp"
kind = "held"
region = { shape = "half_space", normal = "x" }
)";
}

struct Sides {
  double length, height, held, c;
};

Sides sides_of(const Scene& scene) {
  Sides sides{0, 0, -1, motion_of(scene).sound_speed};
  double low = 1, high = -1, left = 1, right = -1;
  for (size_t i = 0; i < scene.body.size(); ++i) {
    const Vec3& x = scene.body.x[i];
    left = std::min(left, x[0]), right = std::max(right, x[0]);
    low = std::min(low, x[2]), high = std::max(high, x[2]);
    if (scene.rule.types[scene.body.type[i]].imposed[0]) sides.held = std::max(sides.held, x[0]);
  }
  sides.length = right - left + 1e-3, sides.height = high - low + 1e-3, sides.held = right - sides.held;
  return sides;
}

TEST(MotionReach, ALoadBendsAndStretches) {
  const Scene down = scene_of(bar("gravity = \"[0, 0, -9.81] m/s^2\"\n") + run_for("1 s"));
  const Sides s = sides_of(down);
  const double modulus = 2.0 / 3 * s.c * s.c;
  const double bends = 1.5 * 9.81 * std::pow(s.held, 4) / (modulus * s.height * s.height),
               sinks = 9.81 * s.height * s.height / (2 * modulus);
  const PieceReach bent = motion_reach(down).pieces.at(0);
  EXPECT_NEAR(bent.beyond.low[2], -2 * (bends + sinks), 1e-9);
  EXPECT_EQ(bent.beyond.high[2], 0);
  EXPECT_EQ(bent.beyond.low[0], 0);
  // Along the bar it only stretches, and static loading has no overshoot.
  const Scene along = scene_of(bar("gravity = \"[9.81, 0, 0] m/s^2\"\n") + run_for("1 s"));
  const double stretches = 9.81 * s.length * s.length / (2 * modulus);
  EXPECT_NEAR(motion_reach(along).pieces.at(0).beyond.high[0], 2 * stretches, 1e-9);
  const Scene still =
      scene_of(bar("gravity = \"[9.81, 0, 0] m/s^2\"\n") +
               "[run]\ndt = \"auto\"\nsteps = 10\nstatic = { tolerance = 0.001 }\n[reach]\nmargin = "
               "\"auto\"\n");
  EXPECT_NEAR(motion_reach(still).pieces.at(0).beyond.high[0], stretches, 1e-9);
  // In no time it falls no further than in free fall.
  const Scene soon = scene_of(bar("gravity = \"[0, 0, -9.81] m/s^2\"\n") + run_for("1 ms"));
  EXPECT_NEAR(motion_reach(soon).pieces.at(0).beyond.low[2], -0.5 * 9.81 * std::pow(duration_of_run(soon), 2),
              1e-9);
  // What holds no more tears off, and falls.
  const Scene weak = scene_of(bar("gravity = \"[0, 0, -9.81] m/s^2\"\n", "1 kPa") + run_for("100 ms"));
  EXPECT_NEAR(motion_reach(weak).pieces.at(0).beyond.low[2], -0.5 * 9.81 * std::pow(duration_of_run(weak), 2),
              1e-6);
}

TEST(MotionReach, APullBreaksAndSpringsBack) {
  const std::string pulled =
      bar("") +
      "[[constraint]]\nname = \"grip\"\nkind = \"moved\"\nvelocity = \"[0.4, 0, 0] m/s\"\n"
      "region = { shape = \"half_space\", point = \"[19, 0, 0] mm\", normal = \"-x\" }\n";
  const Scene far = scene_of(pulled + run_for("20 ms"));
  const Sides s = sides_of(far);
  const PieceReach torn = motion_reach(far).pieces.at(0);
  const double springs = torn.beyond.high[0] - 0.4 * duration_of_run(far);
  // The elastic law pulls most at 0.95 * sqrt(2) pitches or so: well beyond its rest, and before its end.
  EXPECT_GT(springs, 0.05 * s.length);
  EXPECT_LT(springs, 0.414 * s.length);
  EXPECT_NEAR(torn.beyond.low[0], -springs, 1e-9);
  EXPECT_NEAR(torn.beyond.high[2], springs / 2, 1e-9);
  EXPECT_EQ(torn.reasons, (std::vector<std::string>{"the imposed velocity", "a break"}));
  // Before it breaks it follows the grip, but for the wave's overshoot of V/c.
  const Scene near = scene_of(pulled + run_for("0.2 ms"));
  const PieceReach whole = motion_reach(near).pieces.at(0);
  const double t = duration_of_run(near), strain = std::max(0.4 / s.c, 0.4 * t / s.length);
  EXPECT_NEAR(whole.beyond.high[0], 0.4 * t + strain * s.length, 1e-9);
  EXPECT_EQ(whole.beyond.high[2], 0);
}

// A swing of a held bar: 2 v L^2/(c h), or what the time allows.
TEST(MotionReach, AHeldBarSwings) {
  const std::string struck = bar("") + "[[velocity]]\nuniform = \"[0, 0, 0.1] m/s\"\n";
  const Scene scene = scene_of(struck + run_for("1 s"));
  const Sides s = sides_of(scene);
  EXPECT_NEAR(motion_reach(scene).pieces.at(0).beyond.high[2],
              2 * 0.1 * s.length * s.length / (s.c * s.height), 1e-9);
  const Scene soon = scene_of(struck + run_for("1 ms"));
  EXPECT_NEAR(motion_reach(soon).pieces.at(0).beyond.low[2], -0.1 * duration_of_run(soon), 1e-9);
}

// Each particle stays on its circle; in a short time it goes as far as its arc is long.
TEST(MotionReach, ARotationKeepsToItsCircles) {
  const std::string turning = kRubber +
                              "[geometry]\nshape = \"box\"\nsize = \"[8, 4, 2] mm\"\n[[velocity]]\n"
                              "spin = \"[0, 0, 100] rad/s\"\n";
  for (const bool whole : {true, false}) {
    const Scene scene = scene_of(turning + run_for(whole ? "100 ms" : "1 ms"));
    const MotionReach reach = motion_reach(scene);
    const double t = duration_of_run(scene);
    for (size_t i = 0; i < scene.body.size(); ++i) {
      const Vec3 x = scene.body.x[i] - reach.pieces[0].centre;
      const double radius = std::hypot(x[0], x[1]);
      const Ranges way = reach.pieces[0].of(scene.body.x[i], scene.rule.types[0]);
      const double most = whole ? radius - x[0] : std::min(radius * 100 * t, radius - x[0]);
      EXPECT_NEAR(way.high[0], most, 1e-6);
      EXPECT_NEAR(way.low[2], 0, 1e-6);
    }
  }
}

// Particles that nothing binds: each of them may go anywhere at the speed of the fastest.
TEST(MotionReach, ManyPiecesAreOne) {
  std::string text =
      "units = \"reduced\"\nmass = 1.0\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n";
  for (int k = 0; k < 30; ++k)
    text +=
        fmt::format("[[particle]]\nposition = [{}, 0, 0]\nvelocity = [0, {}, 0]\n", 10 * k, k == 7 ? 3 : -1);
  const Scene scene =
      parse_scene(text + "[run]\ndt = 0.001\nsteps = 100\n[reach]\nmargin = \"auto\"\n", "s.toml");
  const MotionReach reach = motion_reach(scene);
  ASSERT_EQ(reach.pieces.size(), 1u);
  EXPECT_EQ(reach.pieces[0].pieces, 30u);
  expect_near(reach.pieces[0].beyond.high, Vec3(0.3, 0.3, 0), 1e-12);  // none leaves z = 0
  expect_near(reach.pieces[0].beyond.low, Vec3(-0.3, -0.3, 0), 1e-12);
  EXPECT_EQ(reach_text(scene, reach, 2.5),
            "2.5 around each particle, a cell edge; 30 pieces of 'matter' x 0.3, y 0.3 more, by the initial "
            "velocities");
}

// Two that fly apart faster than they hold each other: each at its own velocity.
TEST(MotionReach, WhatFliesApartIsNotHeld) {
  const Scene scene = parse_scene(
      "units = \"reduced\"\nmass = 1.0\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n"
      "[[particle]]\nposition = [0, 0, 0]\nvelocity = [0, -9, 0]\n[[particle]]\nposition = [1.12, 0, 0]\n"
      "[run]\ndt = 0.001\nsteps = 2000\n[reach]\nmargin = \"auto\"\n",
      "s.toml");
  const PieceReach piece = motion_reach(scene).pieces.at(0);
  EXPECT_LE(piece.beyond.low[1], -18);
}

TEST(MotionReach, AxesThatRepeatHaveNone) {
  const std::string text = R"(units = "reduced"
mass = 1.0
[packing]
pitch = 1.0
[law]
kind = "elastic"
stiffness = 1.0
[box]
cells = [4, 4, 4]
periodic = "x"
[[velocity]]
uniform = [0.25, 0.5, 0]
[run]
dt = "auto"
steps = 100
[reach]
margin = "auto"
)";
  const Scene scene = parse_scene(text, "s.toml");
  const PieceReach piece = motion_reach(scene).pieces.at(0);
  expect_near(piece.beyond.high, Vec3(0, 0.5 * duration_of_run(scene), 0), 1e-9);
}

// A block of which some is held along axes across its way flies as the whole one: with a plane of symmetry,
// and on rails.
TEST(MotionReach, WhatIsHeldAlongOneAxisFliesAlongOthers) {
  const std::string block =
      kRubber + "[geometry]\nshape = \"box\"\nmin = \"[0, -2, -2] mm\"\nmax = \"[4, 2, 2] mm\"\n";
  const Scene half =
      scene_of(block + "[[symmetry]]\nnormal = \"x\"\n[[velocity]]\nuniform = \"[0, 0, -2] m/s\"\n" +
               run_for("100 ms"));
  const PieceReach flies = motion_reach(half).pieces.at(0);
  EXPECT_NEAR(flies.beyond.low[2], -2 * duration_of_run(half), 1e-9);
  expect_near(flies.beyond.high, Vec3::Zero(), 1e-9);
  EXPECT_EQ(flies.reasons, std::vector<std::string>{"the initial velocity"});
  const std::string rails =
      "[[constraint]]\nname = \"rails\"\nkind = \"held\"\naxes = \"xy\"\nregion = { shape = "
      "\"half_space\", point = \"[1, 0, 0] mm\", normal = \"x\" }\n";
  const Scene led = scene_of("gravity = \"[0, 0, -9.81] m/s^2\"\n" + block + rails + run_for("100 ms"));
  const PieceReach falls = motion_reach(led).pieces.at(0);
  EXPECT_NEAR(falls.beyond.low[2], -0.5 * 9.81 * std::pow(duration_of_run(led), 2), 1e-9);
  EXPECT_EQ(falls.beyond.high[2], 0);
  EXPECT_EQ(falls.reasons, std::vector<std::string>{"gravity"});
  // Along x the rails hold it, and gravity stretches it at most.
  const Scene across = scene_of("gravity = \"[9.81, 0, 0] m/s^2\"\n" + block + rails + run_for("100 ms"));
  EXPECT_LT(motion_reach(across).pieces.at(0).beyond.high[0], 0.1e-3);
}

// In its plane of symmetry a block turns about the normal alone.
TEST(MotionReach, APlaneOfSymmetryLetsABlockTurnAboutItsNormal) {
  const auto spin = [](const std::string& rates) {
    const Scene scene = scene_of(kRubber +
                                 "[geometry]\nshape = \"box\"\nmin = \"[0, -2, -2] mm\"\nmax = \"[4, 2, 2] "
                                 "mm\"\n[[symmetry]]\nnormal = "
                                 "\"x\"\n[[velocity]]\nspin = \"[" +
                                 rates + "] rad/s\"\n" + run_for("10 ms"));
    return motion_reach(scene).pieces.at(0).spin;
  };
  expect_near(spin("20, 0, 0"), Vec3(20, 0, 0), 1e-6);
  EXPECT_EQ(spin("0, 20, 0"), Vec3(0, 0, 0));
}

// A ram that comes from beside strikes a block before it lands, or as it bounces: it flies past the floor.
TEST(MotionReach, ABlowFromBesideOutlivesNoFloor) {
  const auto hit_from = [](double ram) {
    return scene_of("gravity = \"[0, 0, -9.81] m/s^2\"\n" + kRubber +
                    fmt::format(R"([geometry]
shape = "union"
of = ["block", "floor", "ram"]
[regions]
block = {{ shape = "box", min = "[-2, -2, 20] mm", max = "[2, 2, 24] mm" }}
floor = {{ shape = "box", min = "[-4, -4, -2] mm", max = "[4, 4, 0] mm" }}
ram = {{ shape = "box", min = "[{}, -2, 5] mm", max = "[{}, 2, 24] mm" }}
[[material]]
name = "rubber"
[[material]]
name = "ground"
region = "floor"
[[material]]
name = "steel"
region = "ram"
[[bond]]
between = ["rubber", "ground"]
contact = true
[[bond]]
between = ["rubber", "steel"]
contact = true
[[constraint]]
name = "fixed"
kind = "held"
region = "floor"
[[constraint]]
name = "led"
kind = "moved"
velocity = "[0.5, 0, 0] m/s"
region = "ram"
)",
                                ram - 4, ram) +
                    run_for("100 ms"));
  };
  const auto missed = hit_from(-200);
  EXPECT_EQ(of_material(missed, "rubber").stopped_by[2][0], "ground");
  for (const double ram : {-10.0, -40.0}) {  // strikes after 12 ms or so, and after 72; it lands after 63
    const Scene scene = hit_from(ram);
    const PieceReach block = of_material(scene, "rubber");
    EXPECT_EQ(block.stopped_by[2][0], "") << ram;
    // Beside the floor it falls on.
    EXPECT_LT(block.beyond.low[2], -29 * kLayer - 5e-3) << ram;
  }
}

}  // namespace
}  // namespace cuboct
