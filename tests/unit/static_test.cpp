// SPDX-License-Identifier: MIT
// Quasi-static loading: runs of load steps, each a body at rest.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <Eigen/Dense>
#include <chrono>
#include <cmath>
#include <thread>

#include "hw/engine/engine_kind.h"
#include "hw/engine/scene_engine.h"
#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/base/steps.h"
#include "model/run/static_engine.h"
#include "model/solid/vibrations.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

Recorded run_static(const Scene& scene) {
  RunRequest request;
  request.steps = scene.steps;
  request.probes = every_so_often(scene.probe_every, scene.steps);
  request.frames = {0};
  request.energies = request.totals = true;
  return record(scene, scene_reference_kind(scene, scene.body, {}, 1), request);
}

const Curve& curve(const Recorded& run, const std::string& name) {
  for (const Curve& c : run.trace.curves)
    if (c.name == name) return c;
  throw std::runtime_error("no curve " + name);
}

double counter(const Recorded& run, const std::string& name) {
  for (const auto& [key, value] : run.trace.counters)
    if (key == name) return value;
  throw std::runtime_error("no counter " + name);
}

// A bar whose end is pulled by 4e-4 of its length in each of four load steps.
std::string loaded_bar(const std::string& run) {
  const std::string left = "region = { shape = \"half_space\", point = [-3.4, 0, 0], normal = \"x\" }\n",
                    right = "region = { shape = \"half_space\", point = [3.4, 0, 0], normal = \"-x\" }\n";
  return "units = \"reduced\"\nmass = 2.0\n[packing]\npitch = 1.0\naxes = [[1, 1, 0], [-1, 1, 0]]\n"
         "[geometry]\nshape = \"box\"\nsize = [8, 2.1, 2.1]\n[law]\nkind = \"elastic\"\nstiffness = 3.0\n"
         "[damping]\nratio = 0.3\n"
         "[[constraint]]\nname = \"fixed\"\nkind = \"held\"\n" +
         left + "[[constraint]]\nname = \"pulled\"\nkind = \"moved\"\nvelocity = [1e-4, 0, 0]\n" + right +
         "[[probe]]\nname = \"grip\"\nkind = \"force\"\naxis = \"x\"\n" + right +
         "[[probe]]\nname = \"hold\"\nkind = \"force\"\naxis = \"x\"\n" + left + "[run]\ndt = 0.1\n" + run;
}

// The force on the moved particles by the linear equations of the same bonds, with the free particles solved
// for.
double linear_force(Scene scene, double displacement) {
  std::vector<bool> free;
  std::vector<double> given;
  for (const uint8_t type : scene.body.type)
    for (int axis = 0; axis < 3; ++axis) {
      free.push_back(!scene.rule.types[type].imposed[axis]);
      given.push_back(scene.rule.types[type].velocity[axis] > 0 ? displacement : 0);
    }
  for (ParticleType& type : scene.rule.types) type.imposed = {false, false, false};
  const Eigen::MatrixXd k =
      scene.rule.mass * Eigen::MatrixXd(vibrations_of(scene.rule, scene.body, scene.periodic).stiffness);
  std::vector<int> rows;
  for (size_t i = 0; i < free.size(); ++i)
    if (free[i]) rows.push_back(static_cast<int>(i));
  const Eigen::Map<Eigen::VectorXd> imposed(given.data(), static_cast<Eigen::Index>(given.size()));
  Eigen::VectorXd u = imposed;
  const Eigen::VectorXd load = -(k * imposed)(rows);
  const Eigen::VectorXd solved = Eigen::MatrixXd(k(rows, rows)).ldlt().solve(load);
  u(rows) = solved;
  const Eigen::VectorXd force = -(k * u);
  double sum = 0;
  for (size_t i = 0; i < given.size(); ++i)
    if (given[i] > 0) sum += force[static_cast<Eigen::Index>(i)];
  return sum;
}

TEST(Static, ABarInTensionHasTheForceOfTheLinearEquations) {
  const Scene scene =
      parse_scene(loaded_bar("steps = 1100\nstatic = { load_steps = 4, tolerance = 1e-6 }\n"), "bar");
  ASSERT_TRUE(scene.loading);
  EXPECT_EQ(scene.loading->every, 275U);
  EXPECT_EQ(scene.probe_every, 275U);
  const Recorded run = run_static(scene);
  ASSERT_FALSE(run.trace.stop) << run.trace.stop->text;
  const std::vector<double>&grip = curve(run, "grip.force").value, &hold = curve(run, "hold.force").value;
  ASSERT_EQ(grip.size(), 5U);
  for (size_t k = 0; k < grip.size(); ++k) {
    const double expected = linear_force(scene, 275e-5 * static_cast<double>(k));
    // Bonds turn and second neighbours push by the square of the strain, which is up to 1.6e-3.
    EXPECT_NEAR(grip[k], expected, 5e-3 * std::abs(expected) + 3e-9) << k;
    EXPECT_NEAR(grip[k] + hold[k], 0, 1e-6 * std::abs(hold[k]) + 3e-9) << k;
  }
  EXPECT_LT(grip.back(), -1e-2);  // drawn back
  EXPECT_EQ(counter(run, "load_steps"), 4);
  EXPECT_EQ(run.trace.curves[0].step, (std::vector<uint64_t>{0, 275, 550, 825, 1100}));
  EXPECT_EQ(run.trace.bodies.back().step, 1100U);
  for (const double kinetic : curve(run, "energy.kinetic").value) EXPECT_EQ(kinetic, 0);
}

// A linear body goes on as it went: the first load step is the only one that costs.
TEST(Static, EqualLoadStepsBeginWhereTheLastOneWent) {
  const auto evaluations = [](const char* count) {
    return counter(
        run_static(parse_scene(loaded_bar("steps = 1200\nstatic = { tolerance = 1e-3, load_steps = " +
                                          std::string(count) + " }\n"),
                               "bar")),
        "force_evaluations");
  };
  const double one = evaluations("1"), ten = evaluations("10");
  EXPECT_GT(one, 20);
  EXPECT_LT(ten, 3 * one);
}

// A particle lies on a plate that it only touches: the push is its weight. Step 0 is before that.
TEST(Static, ContactCarriesTheWeight) {
  const std::string scene =
      "units = \"reduced\"\nmass = 1.0\ngravity = [0, 0, -0.5]\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = "
      "1.0\n"
      "cutoff = 2.5\nsmooth = \"linear\"\n[[material]]\nname = \"plate\"\n[[material]]\nname = \"ball\"\n"
      "region = { shape = \"sphere\", radius = 0.5, centre = [0, 0, 1.1] }\n"
      "[[bond]]\nbetween = [\"plate\", \"ball\"]\ncontact = true\n"
      "[[constraint]]\nname = \"held\"\nkind = \"held\"\nregion = { shape = \"sphere\", radius = 0.5 }\n"
      "[[particle]]\nposition = [0, 0, 0]\n[[particle]]\nposition = [0, 0, 1.1]\n"
      "[[probe]]\nname = \"plate\"\nkind = \"force\"\naxis = \"z\"\nregion = { shape = \"sphere\", radius = "
      "0.5 }\n"
      "[run]\ndt = 0.001\nsteps = 10\nstatic = true\n";
  const Scene read = parse_scene(scene, "plate");
  const Recorded run = run_static(read);
  ASSERT_FALSE(run.trace.stop) << run.trace.stop->text;
  EXPECT_NEAR(curve(run, "plate.force").value.front(), 0, 1e-3 * 0.5);
  EXPECT_GT(run.trace.bodies.front().x[1].z(), run.trace.bodies.back().x[1].z() + 1e-3);
  EXPECT_NEAR(curve(run, "plate.force").value.back(), -0.5, 1e-3 * 0.5);
  EXPECT_NEAR(read.rule.law->force(run.trace.bodies.back().x[1].z()), 0.5, 1e-3 * 0.5);
}

// Nothing loads the pair: it stands at step 0 as it begins, and then goes where the law has no force.
TEST(Static, WithoutLoadStepZeroIsTheBodyAsItBegins) {
  const Scene scene = parse_scene(
      "units = \"reduced\"\nmass = 1.0\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n"
      "[[particle]]\nposition = [0, 0, 0]\n[[particle]]\nposition = [1.3, 0, 0]\n"
      "[run]\ndt = 0.001\nsteps = 10\nstatic = { load_steps = 1 }\n",
      "pair");
  const Recorded run = run_static(scene);
  ASSERT_FALSE(run.trace.stop) << run.trace.stop->text;
  const auto apart = [](const RealFrame& frame) { return (frame.x[1] - frame.x[0]).norm(); };
  EXPECT_EQ(apart(run.trace.bodies.front()), 1.3);
  EXPECT_NEAR(apart(run.trace.bodies.back()), std::pow(2, 1.0 / 6), 1e-6);
}

// A sleep is never shorter than it says.
TEST(Static, HostTimeCountsHowTheBodyCameToRest) {
  const Scene scene = parse_scene(loaded_bar("steps = 100\nstatic = { load_steps = 1 }\n"), "bar");
  EngineKind kind = scene_reference_kind(scene, scene.body, {}, 1);
  constexpr std::chrono::milliseconds kSleep{20};
  kind.make = [&scene, kSleep](CheckpointReader*, bool) {
    std::this_thread::sleep_for(kSleep);
    return std::make_unique<StaticEngine>(scene, scene.body, 1, 1);
  };
  RunRequest request;
  request.steps = 0;
  EXPECT_GE(record(scene, kind, request).trace.seconds, 0.02);
}

TEST(Static, ABodyThatFallsFindsNoRest) {
  const Scene scene = parse_scene(
      "units = \"reduced\"\nmass = 1.0\ngravity = [0, 0, -1]\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = "
      "1.0\n"
      "cutoff = 2.5\n[[particle]]\nposition = [0, 0, 0]\n[[particle]]\nposition = [1.1, 0, 0]\n"
      "[run]\ndt = 0.001\nsteps = 10\nstatic = { evaluations = 300 }\n",
      "falls");
  const Recorded run = run_static(scene);
  ASSERT_TRUE(run.trace.stop);
  EXPECT_NE(
      run.trace.stop->text.find("step 0: the body finds no rest: after 300 force evaluations 2 N are "
                                "unbalanced, the load is 2 N; is a part of it free to fall or to drift?"),
      std::string::npos)
      << run.trace.stop->text;
}

TEST(Static, IsForTheEngineThatRelaxes) {
  const Scene scene = parse_scene(loaded_bar("steps = 100\nstatic = true\n"), "bar.toml");
  const Plan plan = plan_of(scene, {});
  RunRequest request;
  request.steps = 1;
  EXPECT_EQ(refused_with([&] { record(scene, golden_kind(scene, plan), request); }),
            "bar.toml:36:10: static loading is not for the golden engine\n  hint: the reference engine "
            "relaxes; 'static = false' lets the body move");
  EXPECT_THROW(scene_reference_kind(scene, plan, {.precision = Precision::float32}), InputError);
  EXPECT_THROW(scene_reference_kind(scene, plan, {.integrator = Integrator::velocity_verlet}), InputError);
}

TEST(Static, IsReadAndSwitchedOffByAStage) {
  const std::string stages =
      loaded_bar("steps = 100\nprobe_every = 7\nstatic = { load_steps = 10 }\n") +
      "[[stage]]\nname = \"load\"\n[[stage]]\nname = \"move\"\nstatic = false\nsteps = 33\n";
  const Scene load = parse_scene(stages, "bar.toml", {.begins = true, .stage = "load"});
  ASSERT_TRUE(load.loading);
  EXPECT_EQ(load.probe_every, 10U);
  EXPECT_EQ(load.energy_every, 10U);
  EXPECT_EQ(load.loading->tolerance, 1e-3);
  const Scene move = parse_scene(stages, "bar.toml", {.begins = true, .stage = "move"});
  EXPECT_FALSE(move.loading);
  EXPECT_EQ(move.steps, 33U);
  EXPECT_EQ(move.probe_every, 7U);
  for (const auto& [keys, message] : {std::pair{"static = { load_step = 3 }", "unknown key 'load_step'"},
                                      {"static = { tolerance = 0.0 }", "'tolerance' must be"},
                                      {"static = 4", "'static' must be true or false"}}) {
    try {
      parse_scene(loaded_bar("steps = 100\n" + std::string(keys) + "\n"), "bar.toml");
      ADD_FAILURE() << keys;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("bar.toml:"), std::string::npos) << error.what();
    }
  }
}

// The elastic law ends 0.414 pitches beyond the pitch; 0.207 are moved in 2070 steps of dt.
TEST(Static, ALoadStepThatWouldTearBondsIsAnError) {
  const auto pulled = [](int steps) {
    return parse_scene(loaded_bar(fmt::format("steps = {}\nstatic = {{ load_steps = 1 }}\n", steps)), "bar");
  };
  pulled(20700);
  try {
    pulled(20800);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("a load step moves a constraint by 0.208 pitches at once, 0.207 may do"),
              std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("load_steps = 2 or more"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace cuboct
