// SPDX-License-Identifier: MIT
// Noise of rules of text: its moments, what it depends on, and the thermostats that are made of it.
// docs/reference/thermostats.md has the derivations.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "model/graph/noise.h"
#include "model/scene/first_step.h"
#include "tests/rules/in_integers.h"

namespace cuboct {
namespace {

Scene scene_with_noise(const std::string& text) { return parse_scene(text, kIntegerTexts + "test.toml"); }

// A particle draws a number and a vector, and sums what its pairs draw.
const std::string kDraws = small_block("run = { dt = \"1 us\", steps = 10 }\n") +
                           "[rule]\nreach = \"1.2 * pitch\"\nstill = true\nparameters.other = 2\n"
                           "particle.a = { range = [-2, 2] }\n"
                           "particle.b = { range = [-2, 2] }\n"
                           "particle.w = { kind = \"vector\", range = [-2, 2] }\n"
                           "particle.pairs = { range = [-20, 20] }\n"
                           "particle.frozen.start = \"noise(1)\"\n"
                           "[[rule.round]]\nsum.drawn = \"noise(1)\"\n"
                           "finish = { a = \"noise(1)\", b = \"noise(other)\", w = \"noises(1)\", "
                           "pairs = \"drawn\" }\n";

std::vector<std::vector<double>> fields_of(RoundsRun& run) {
  return std::get<RealFrame>(run.frame(false)).shown;
}

struct Moments {
  double n = 0, first = 0, second = 0, fourth = 0, product = 0;
  void add(double x, double y) {
    n += 1, first += x, second += x * x, fourth += x * x * x * x, product += x * y;
  }
};

// A uniform number x of variance 1 has <x^4> = 9/5, so that x^2 has the variance 4/5, and <x^8> = 9, so that
// x^4 has 9 - 81/25. The mean of n numbers is off by five standard errors in one of two million tries.
TEST(Noise, HasMeanZeroVarianceOneAndNoMemory) {
  const Scene scene = scene_with_noise(kDraws);
  RoundsRun run(scene, scene.body, {}, 1e-3);
  std::map<std::string, Moments> all;
  std::vector<double> before;
  double largest = 0;
  constexpr int kSteps = 100;
  for (int step = 0; step < kSteps; ++step, run.advance(1, nullptr)) {
    const std::vector<std::vector<double>> fields = fields_of(run);
    const std::vector<double>&a = fields[0], &b = fields[1], &w = fields[2];
    for (size_t i = 0; i < a.size(); ++i) {
      all["of two seeds"].add(a[i], b[i]);
      all["of number and vector"].add(a[i], w[3 * i]);
      all["of x and y"].add(w[3 * i], w[3 * i + 1]);
      all["of y and z"].add(w[3 * i + 1], w[3 * i + 2]);
      if (i > 0) all["of two particles"].add(a[i], a[i - 1]);
      if (step > 0) all["of two steps"].add(a[i], before[i]);
      largest = std::max(largest, std::abs(a[i]));
    }
    before = a;
  }
  EXPECT_EQ(all.size(), 6u);
  for (const auto& [what, of] : all) {
    ASSERT_GT(of.n, 10000) << what;
    const double error = 5 / std::sqrt(of.n);
    EXPECT_NEAR(of.first / of.n, 0, error) << what;
    EXPECT_NEAR(of.second / of.n, 1, error * std::sqrt(0.8)) << what;
    EXPECT_NEAR(of.fourth / of.n, 1.8, error * 2.4) << what;
    EXPECT_NEAR(of.product / of.n, 0, error) << what;
  }
  EXPECT_LT(largest, std::numbers::sqrt3);
  EXPECT_GT(largest, 0.999 * std::numbers::sqrt3);
}

// Four particles, a pair in each of two planes.
TEST(Noise, OfAPairIsThatOfBothEndsAndOfTheStep) {
  std::string four = kDraws;
  four.replace(four.find("[6, 3, 3]"), 9, "[1, 1, 1]");
  four.replace(four.find("\"noise(1)\"", four.find("sum.drawn")), 10,
               "{ is = \"noise(1)\", when = \"abs(d.z) < 0.1 mm\" }");
  const Scene scene = scene_with_noise(four);
  ASSERT_EQ(scene.body.size(), 4u);
  RoundsRun run(scene, scene.body, {}, 1e-3);
  const std::vector<std::vector<double>> first = fields_of(run);
  const auto expect_pairs = [&](const std::vector<std::vector<double>>& fields) {
    std::map<double, int> met;
    for (size_t i = 0; i < 4; ++i) {
      ++met[fields[3][i]];
      EXPECT_NE(fields[3][i], fields[0][i]);
    }
    ASSERT_EQ(met.size(), 2u);
    EXPECT_EQ(met.begin()->second, 2);
  };
  expect_pairs(first);
  EXPECT_EQ(fields_of(run), first);  // a look draws nothing anew
  run.advance(1, nullptr);
  const std::vector<std::vector<double>> second = fields_of(run);
  expect_pairs(second);
  for (size_t k = 0; k < 4; ++k) EXPECT_NE(second[k][0], first[k][0]) << k;
  EXPECT_EQ(second[4], first[4]);  // what a start draws stays
  EXPECT_NE(first[4][0], first[4][1]);
}

// It goes on where a run was cut, and where another run goes on from it.
TEST(Noise, CountsTheStepsOfAllRuns) {
  const Scene scene = scene_with_noise(kDraws);
  RoundsRun whole(scene, scene.body, {}, 1e-3), cut(scene, scene.body, {}, 1e-3, 17);
  Scene later = scene_with_noise(kDraws);
  begin_at_step(later.rule, 17);
  EXPECT_EQ(first_step_of(later.rule), 17u);
  RoundsRun next(later, later.body, {}, 1e-3);
  whole.advance(17, nullptr);
  EXPECT_EQ(fields_of(cut), fields_of(whole));
  EXPECT_EQ(fields_of(next), fields_of(whole));
  for (RoundsRun* run : {&whole, &cut, &next}) run->advance(3, nullptr);
  EXPECT_EQ(fields_of(cut), fields_of(whole));
  EXPECT_EQ(fields_of(next), fields_of(whole));
}

// A field that adds up what is drawn has in integers what it has in doubles. The unit of noise in that of a
// field is a factor of 26 bits; 12 steps round some 12 terms to 46 bits over 400 each.
TEST(Noise, IsTheSameInIntegers) {
  std::string walk = kDraws;
  walk.replace(walk.find("\"noise(1)\", b"), 13, "\"a + noise(1)\", b");
  walk.replace(walk.find("\"drawn\""), 7, "\"pairs + drawn\"");
  for (const char* range : {"a = { range = [-2, 2]", "pairs = { range = [-20, 20]"}) {
    const size_t at = walk.find(range);
    ASSERT_NE(at, std::string::npos);
    const size_t brackets = walk.find('[', at);
    walk.replace(brackets, walk.find(']', at) + 1 - brackets, "[-200, 200]");
  }
  const InIntegers made(walk, 16, 1000);
  IntegerRun golden = made.run();
  RoundsRun doubles(made.scene, made.scene.body, {}, 1e-3);
  golden.advance(12, nullptr), doubles.advance(12, nullptr);
  const std::vector<std::vector<double>> here = fields_of(golden), there = fields_of(doubles);
  for (const size_t field : {0, 3})
    for (size_t i = 0; i < here[field].size(); ++i)
      EXPECT_NEAR(here[field][i], there[field][i], std::abs(there[field][i]) * 0x1p-25 + 1e-9)
          << field << " of " << i;
}

std::string shaken(const std::string& rule, double pitch, double dt, const std::string& geometry) {
  return fmt::format(
      "units = \"reduced\"\nmass = 2\npacking = {{ pitch = {} }}\n{}\n"
      "run = {{ dt = {}, steps = 10 }}\n{}",
      pitch, geometry, dt, rule);
}

// Of half before and half after a step, as probes have it; without a centre of mass.
struct Means {
  double thermal_energy = 0, square = 0;  // of x beside its home
  int count = 0;
};
Means means_of(const Scene& scene, int rest, int steps, int every) {
  RoundsRun run(scene, scene.body, {}, 1);
  run.advance(static_cast<uint64_t>(rest), nullptr);
  Means means;
  Asked asked;
  asked.energies = true;
  const auto degrees = 3 * static_cast<double>(scene.body.size());
  for (int k = 0; k < steps; k += every, ++means.count) {
    run.advance(static_cast<uint64_t>(every), nullptr);
    means.thermal_energy += 2 * run.read(asked).energies.kinetic / degrees;
    const std::vector<Vec3> x = std::get<RealFrame>(run.frame(false)).x;
    for (size_t i = 0; i < x.size(); ++i) means.square += (x[i] - scene.body.x[i]).squaredNorm() / degrees;
  }
  means.thermal_energy /= means.count, means.square /= means.count;
  return means;
}

// Particles far from one another, friction dt = 1/2: velocities between steps are hotter by
// 1/(1 - friction dt/2) = 4/3, those of full steps have the temperature.
TEST(Noise, LangevinsBathHasItsTemperatureAtAnyTimeStep) {
  const Scene scene = scene_with_noise(shaken(
      "rule = { file = \"texts/langevin.toml\", parameters = { friction = 10, thermal_energy = 3 } }\n", 10,
      0.05, "box = { cells = [7, 7, 7], periodic = \"xyz\" }"));
  ASSERT_EQ(scene.body.size(), 1372u);
  const Means means = means_of(scene, 30, 60, 4);
  // 3 * 1372 numbers, 15 times: a standard error of sqrt(2/61740) = 0.57 %.
  EXPECT_NEAR(means.thermal_energy / 3, 1, 0.023);
}

// omega dt = 1, friction dt = 1/2. What a particle is off its home is too much by
// 1/(1 - (omega dt)^2/(4 - 2 friction dt)) = 3/2; the velocity is right.
TEST(Noise, OfASpringTheMomentsAreThoseDerived) {
  const Scene scene = scene_with_noise(
      shaken("[rule]\nreach = 1\nparticle.home = { kind = \"vector\", start = \"x\" }\n[[rule.round]]\n"
             "finish.force = \"-mass * 400 * (x - home) - mass * 10 * v + sqrt(2 * mass * 10 * 3 / dt) * "
             "noises(5)\"\n",
             10, 0.05, "geometry = { shape = \"box\", min = [-45, -45, -45], max = [45, 45, 45] }"));
  const Means means = means_of(scene, 40, 100, 4);
  const auto samples = 3 * static_cast<double>(scene.body.size()) * means.count;
  ASSERT_GT(samples, 70000);
  EXPECT_NEAR(means.thermal_energy / 3, 1, 4 * std::sqrt(2 / samples));
  EXPECT_NEAR(means.square / (3.0 / 2 / 400), 1.5, 1.5 * 4 * std::sqrt(2 / samples));
}

// The temperature forgets in 7 steps: some 20 independent samples of 768 numbers have a standard error of 1
// %.
TEST(Noise, DissipativeParticlesHaveTheirTemperatureAndKeepMomentum) {
  const auto fluid = [](double dt, const std::string& body) {
    return "velocity = [ { thermal_energy = 1, seed = 3 } ]\n" +
           shaken("rule = { file = \"texts/dpd.toml\", parameters.thermal_energy = 2 }\n", 0.77827, dt, body);
  };
  const Means means =
      means_of(scene_with_noise(fluid(0.04, "box = { cells = [4, 4, 4], periodic = \"xyz\" }")), 60, 150, 5);
  EXPECT_NEAR(means.thermal_energy / 2, 1, 0.06);

  const InIntegers made(
      fluid(0.005, "geometry = { shape = \"box\", min = [0, 0, 0], max = [2.5, 2.5, 2.5] }"), 64);
  IntegerRun golden = made.run();
  RoundsRun doubles(made.scene, made.scene.body, {}, 1);
  const Momentum before = golden.momentum();
  golden.advance(30, nullptr), doubles.advance(30, nullptr);
  EXPECT_EQ(golden.momentum().fixed, before.fixed);
  const std::vector<Vec3> here = std::get<RealFrame>(golden.frame(false)).x,
                          there = std::get<RealFrame>(doubles.frame(false)).x;
  double moved = 0, off = 0;
  for (size_t i = 0; i < here.size(); ++i) {
    moved = std::max(moved, (there[i] - made.scene.body.x[i]).norm());
    off = std::max(off, (here[i] - there[i]).norm());
  }
  EXPECT_GT(moved, 0.2);
  EXPECT_LT(off, 1e-3);
  // Random forces of sqrt(2 friction kT/dt) = 42 a pair: a look at either has the noise of the step to come.
  const std::vector<Vec3> pulls = std::get<RealFrame>(golden.frame(true)).force,
                          same = std::get<RealFrame>(doubles.frame(true)).force;
  for (size_t i = 0; i < pulls.size(); ++i) EXPECT_LT((pulls[i] - same[i]).norm(), 0.5) << i;
}

// Friction and noise of a finish stand beside the sum, whose bits stay those of a velocity.
TEST(Noise, WhatAFinishAddsCoarsensNoForce) {
  const std::string body = "geometry = { shape = \"box\", min = [0, 0, 0], max = [4, 4, 4] }";
  for (const char* order : {"force + 0 * noises(1) * mass", "0 * noises(1) * mass - (-force)"}) {
    const std::string rule =
        "[rule]\nreach = 1.5\n[[rule.round]]\n"
        "sum.force = \"-(1 - r / reach) * d / r\"\n" +
        fmt::format("finish.force = \"{}\"\n", order);
    const std::string plain = rule.substr(0, rule.find("finish"));
    const InIntegers made(shaken(rule, 1.2, 0.01, body)), alone(shaken(plain, 1.2, 0.01, body));
    IntegerRun here = made.run(), there = alone.run();
    here.advance(20, nullptr), there.advance(20, nullptr);
    EXPECT_EQ(std::get<RealFrame>(here.frame(false)).v, std::get<RealFrame>(there.frame(false)).v);
    Asked asked;
    asked.energies = true, asked.volume = 10;
    EXPECT_EQ(here.read(asked).stress, there.read(asked).stress);
  }
}

// Bonds of uneven strength: what a start draws of a bond is the same from either end, or it were refused.
TEST(Noise, MakesBondsUneven) {
  const std::string uneven = small_block("run = { dt = \"0.2 us\", steps = 10 }\n") +
                             "[rule]\nbonds = \"reference\"\nreach = \"1.2 * pitch\"\n"
                             "bond.set = { unit = \"m\", range = \"[-0.2, 0.2] mm\" }\n"
                             "bond.limit = { unit = \"m\", start = \"0.01 * r0 * (1 + 0.1 * noise(3))\" }\n"
                             "[[rule.round]]\nbond.set = \"max(min(set, r - r0 + limit), r - r0 - limit)\"\n"
                             "sum.force = \"1 kN/m * (r - r0 - set) * d / r\"\n";
  EXPECT_EQ(integer_refusal(uneven), "accepted");
  const Scene scene = scene_with_noise(uneven);
  const ProgramStart start = starts_of(*scene.rule.rounds->text(), scene.rule, scene.body, scene.periodic);
  const auto [least, most] = std::ranges::minmax(start.bond[1]);
  EXPECT_NEAR(least, 1e-5 * (1 - 0.1 * std::numbers::sqrt3), 1e-8);
  EXPECT_NEAR(most, 1e-5 * (1 + 0.1 * std::numbers::sqrt3), 1e-8);
}

std::string noise_refusal(const std::string& rule, const std::string& run = "steps = 10") {
  const std::string text =
      "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\" }\n"
      "box = { cells = [3, 3, 3] }\nrun = { dt = \"1 ms\", " +
      run +
      " }\n"
      "[rule]\nreach = \"1.2 * pitch\"\n" +
      rule;
  try {
    parse_scene(text, kIntegerTexts + "s.toml");
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("/s.toml") + 1);
  }
  return "none";
}

TEST(Noise, WhatCannotBeDrawnIsRefusedAtItsPlace) {
  const auto of_sum = [](const std::string& formula) {
    return noise_refusal("still = true\n[[rule.round]]\nsum.a = \"" + formula + "\"\n");
  };
  EXPECT_EQ(of_sum("noise(3)"), "none");
  EXPECT_EQ(of_sum("noise(0.5)"), "s.toml:9:16: a seed is a whole number from 0 to 1073741823, not 0.5");
  EXPECT_EQ(of_sum("noise(-1)"), "s.toml:9:16: a seed is a whole number from 0 to 1073741823, not -1");
  EXPECT_EQ(of_sum("noise(r / reach)"),
            "s.toml:9:16: a seed is a constant\n  hint: noise(1), or a parameter");
  EXPECT_EQ(of_sum("noise()"), "s.toml:9:10: 'noise' takes 1 argument, not 0\n  hint: noise(seed)");
  EXPECT_EQ(of_sum("noises(1) + noise(1)"), "s.toml:9:10: '+' between a number and a vector");
  EXPECT_EQ(noise_refusal("still = true\nenergy.pair = \"1 J * noise(1)\"\n[[rule.round]]\nsum.a = \"r\"\n"),
            "s.toml:8:22: nothing is drawn here: 'noise' is of rounds and of starts\n"
            "  hint: a field may hold what a finish or a start draws");
  EXPECT_EQ(noise_refusal("stiffness = \"1 N/m\"\n[[rule.round]]\nsum.force = \"1 N * noise(1) * d / r\"\n",
                          "steps = 10, static = { load_steps = 2 }"),
            "s.toml:5:1: static loading leaves out time, and the rule draws noise in each step");
}

}  // namespace
}  // namespace cuboct
