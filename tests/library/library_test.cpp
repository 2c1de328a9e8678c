// SPDX-License-Identifier: MIT
// The C++ library as its users see it: by cuboct/cuboct.h alone.
#include <cuboct/cuboct.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/folder.h"

namespace {

using cuboct::Options;
using cuboct::Simulation;

const std::string kBlock = CUBOCT_SOURCE_DIR "/scenes/lj_block.toml",
                  kCoupon = CUBOCT_SOURCE_DIR "/scenes/coupon.toml";

Options with(const std::string& engine) {
  Options options;
  options.engine = engine;
  return options;
}

using cuboct::test::Folder;

TEST(Library, EnginesHoldTheSameBits) {
  Simulation lattice(kBlock, with("lattice")), golden(kBlock, with("golden"));
  const auto begin = lattice.hash();
  EXPECT_EQ(golden.hash(), begin);
  lattice.step(3);
  golden.step(2);
  EXPECT_NE(golden.hash(), lattice.hash());
  golden.step();
  EXPECT_EQ(golden.hash(), lattice.hash());
  EXPECT_NE(lattice.hash(), begin);
  EXPECT_EQ(golden.positions(), lattice.positions());
  EXPECT_EQ(golden.velocities(), lattice.velocities());
  EXPECT_EQ(lattice.steps(), 3u);
  EXPECT_EQ(lattice.time(), 3 * lattice.dt());
  EXPECT_EQ(lattice.positions().size(), lattice.particles());
  EXPECT_EQ(lattice.types().size(), lattice.particles());
  EXPECT_EQ(lattice.type_masses().size(), lattice.type_names().size());
  EXPECT_EQ(lattice.plan_hash(), golden.plan_hash());

  // Doubles are near to the fixed rule, and have no hash. The box of this scene is not periodic.
  Simulation doubles(kCoupon, with("reference")), fixed(kCoupon, with("lattice"));
  EXPECT_FALSE(doubles.hash());
  doubles.step(20), fixed.step(20);
  const auto near = doubles.positions(), found = fixed.positions();
  ASSERT_EQ(near.size(), found.size());
  double largest = 0;
  for (size_t i = 0; i < near.size(); ++i)
    for (size_t a = 0; a < 3; ++a) largest = std::max(largest, std::abs(near[i][a] - found[i][a]));
  EXPECT_LT(largest, 1e-7);  // m, of a pitch of 1e-3 m
  EXPECT_GT(largest, 0);
}

TEST(Library, CrosscheckComparesThem) {
  const cuboct::Crosscheck found = cuboct::crosscheck(kBlock, {"golden", "lattice"}, 2);
  EXPECT_TRUE(found.matched);
  EXPECT_EQ(found.text, "matched 512 updates over 2 steps in 2 engines");
  EXPECT_EQ(found.updates, 512u);
  EXPECT_EQ(found.steps, 2u);
  EXPECT_FALSE(found.step);
}

TEST(Library, CurvesAndEnergiesHaveUnits) {
  Options options = with("lattice");
  options.probe_every = 20;
  Simulation coupon(kCoupon, options);
  coupon.step(40);
  const Simulation::Curve stress = coupon.curve("tension.stress");
  EXPECT_EQ(stress.unit, "Pa");
  ASSERT_EQ(stress.steps.size(), stress.values.size());
  EXPECT_EQ(stress.steps, (std::vector<uint64_t>{0, 20, 40}));
  const Simulation::Energies energies = coupon.energies();
  EXPECT_GT(energies.kinetic, 0);
  EXPECT_NEAR(energies.total, energies.kinetic + energies.potential + energies.gravity,
              1e-12 * energies.kinetic);
  bool found = false;
  for (const Simulation::Curve& curve : coupon.curves())
    if (curve.name == "energy.kinetic") {
      found = true;
      EXPECT_EQ(curve.unit, "J");
    }
  EXPECT_TRUE(found);
  try {
    coupon.curve("tension.stres");
    FAIL();
  } catch (const cuboct::InputRefused& error) {
    EXPECT_STREQ(error.what(), "no curve 'tension.stres'\n  hint: did you mean 'tension.stress'?");
    EXPECT_EQ(error.line, 0);
  }
}

TEST(Library, LoadsChangeOnTheWay) {
  Simulation still(kCoupon, with("lattice")), faster(kCoupon, with("lattice"));
  still.step(5), faster.step(5);
  std::string held;
  for (const std::string& name : faster.type_names())
    if (const size_t at = name.find('/'); at != std::string::npos) held = name.substr(at + 1);
  faster.set_velocity(held, {0, 0, 0});
  still.step(5), faster.step(5);
  EXPECT_NE(faster.hash(), still.hash());
  try {
    faster.set_velocity("grips", {1, 0, 0});
    FAIL();
  } catch (const cuboct::InputRefused& error) {
    EXPECT_EQ(error.message.substr(0, 61), "no particle is held or moved by a constraint 'grips'")
        << error.what();
  }
}

TEST(Library, AStateGoesOn) {
  const Folder folder;
  Simulation whole(kBlock, with("lattice")), first(kBlock, with("lattice"));
  first.step(4);
  first.leave(folder.path("state"));
  Options options = with("golden");
  options.from = folder.path("state");
  Simulation second(kBlock, options);
  Simulation moved = std::move(second);
  moved.step(3);
  whole.step(7);
  EXPECT_EQ(moved.hash(), whole.hash());
}

// A lone particle that leaves the lattice.
const std::string kLone = R"(mass = "1 mg"
law = { kind = "spline", r = "[0, 1] mm", force = "[1, 0] mN", core = "0.5 mm" }
particle = [{ position = "[0, 0, 0] mm", velocity = "[2, 1, 0.5] m/s" }]
run = { dt = "10 us", steps = 100000 }
)";

TEST(Library, WhatIsWrongHasItsPlace) {
  const auto refusal = [](auto make) {
    try {
      make();
    } catch (const cuboct::InputRefused& error) {
      return error;
    }
    ADD_FAILURE() << "not refused";
    return cuboct::InputRefused("", "", "");
  };
  const auto wrong = refusal([] {
    Simulation(cuboct::SceneText{kLone + "  tittle = 3\n", "made.toml"}, with("lattice"));
  });
  EXPECT_EQ(wrong.file, "made.toml");
  EXPECT_EQ(wrong.line, 5);
  EXPECT_EQ(wrong.column, 3);
  EXPECT_EQ(wrong.message, "unknown key 'tittle'");
  EXPECT_EQ(wrong.hint, "did you mean 'title'?");
  EXPECT_EQ(std::string(wrong.what()),
            "made.toml:5:3: unknown key 'tittle'\n   5 |   tittle = 3\n     |   ^\n  hint: did you mean "
            "'title'?");
  EXPECT_EQ(refusal([] { Simulation("no/such.toml"); }).message, "no/such.toml: cannot read this file");
  EXPECT_EQ(refusal([] { Simulation(kBlock, with("goldn")); }).hint, "did you mean 'golden'?");
  Options options;
  options.threads = -1;
  EXPECT_EQ(refusal([&] { Simulation(kBlock, options); }).message, "threads = -1: from 1 to 4096, or 0");
  options = {};
  options.precision = "half";
  EXPECT_EQ(refusal([&] { Simulation(kBlock, options); }).hint, "one of fixed, float or double");
  options = {};
  options.arch = kBlock;
  EXPECT_NE(refusal([&] { Simulation(kBlock, options); }).line, 0);
}

TEST(Library, AStepThatCannotBeDone) {
  Simulation simulation(cuboct::SceneText{kLone}, with("lattice"));
  uint64_t step = 0;
  try {
    simulation.run();
    FAIL();
  } catch (const cuboct::RunStopped& stopped) {
    step = stopped.step;
    EXPECT_NE(stopped.message.find("left the lattice along x"), std::string::npos) << stopped.message;
    EXPECT_NE(stopped.hint.find("reach"), std::string::npos) << stopped.hint;
    EXPECT_NE(std::string(stopped.what()).find("hint: "), std::string::npos);
  }
  EXPECT_GT(step, 10u);
  EXPECT_EQ(simulation.steps(), step);
  const auto last = simulation.hash();
  EXPECT_THROW(simulation.step(), cuboct::RunStopped);
  EXPECT_EQ(simulation.hash(), last);
}

// As any program does that catches nothing.
TEST(Library, ACtrlCEndsTheProgram) {
  int begun[2];
  ASSERT_EQ(pipe(begun), 0);
  const pid_t child = fork();
  if (child == 0) {
    Simulation simulation(kCoupon, with("golden"));
    simulation.step();
    if (write(begun[1], "!", 1) != 1) _exit(3);
    while (simulation.steps() < 1'000'000) simulation.step(100);
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(begun[0], &byte, 1), 1);
  kill(child, SIGINT);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) << status;
}

TEST(Library, EnginesThatAreProgramsAreFoundBesideIt) {
  if (!std::filesystem::exists(CUBOCT_BUILD_DIR "/cuboct-systemc")) GTEST_SKIP() << "no cuboct-systemc";
  Simulation systemc(kBlock, with("systemc")), golden(kBlock, with("golden"));
  systemc.step(2), golden.step(2);
  EXPECT_EQ(systemc.hash(), golden.hash());
  cuboct::look_for_programs_in("/nowhere");
  EXPECT_THROW(Simulation(kBlock, with("systemc")).step(), cuboct::InputRefused);
  EXPECT_EQ(cuboct::version(), CUBOCT_VERSION);
}

}  // namespace
