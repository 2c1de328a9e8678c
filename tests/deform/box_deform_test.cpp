// SPDX-License-Identifier: MIT
// Boxes that deform, and stress probes: the steps by hand, the work that the box does, elastic constants, and
// what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hw/engine/engine_kind.h"
#include "hw/engine/scene_engine.h"
#include "hw/plan/setup.h"
#include "model/base/steps.h"
#include "model/real/reference.h"
#include "model/run/reference_engine.h"
#include "model/run/static_engine.h"
#include "model/solid/dynamical_matrix.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

const SceneChoice kBegins{.begins = true, .stage = {}};

// A warm crystal of Lennard-Jones particles.
std::string lj_crystal(const std::string& deform, const std::string& more = "", const std::string& run = "") {
  return "units = \"reduced\"\nmass = 1.0\n[packing]\npitch = \"relaxed\"\n"
         "[box]\ncells = [4, 4, 5]\nperiodic = \"xyz\"\n" +
         deform + "\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.0\n" + more + "[run]\n" +
         (run.empty() ? "dt = 0.004\nsteps = 300\nprobe_every = 1\n" : run);
}
const std::string kWarmth = "[[velocity]]\nthermal_energy = 0.1\nseed = 3\n";
std::string stress_probe(const std::string& keys, const std::string& name = "box") {
  return "[[probe]]\nkind = \"stress\"\nname = \"" + name + "\"\n" + keys;
}

Scene deforming(const std::string& text) { return parse_scene(text, "a.toml", kBegins); }
std::string refused(const std::string& text) {
  return refused_with([&] { deforming(text); });
}

Recorded recorded(const Scene& scene, const RealOptions& options = {}) {
  RunRequest request;
  request.steps = scene.steps;
  request.probes = every_so_often(scene.probe_every, scene.steps);
  request.energies = request.watch = true;
  return record(scene, scene_reference_kind(scene, scene.body, options, 1), request);
}

const std::vector<double>& values_of(const Recorded& run, const std::string& name) {
  for (const Curve& c : run.trace.curves)
    if (c.name == name) return c.value;
  throw std::runtime_error("no curve " + name);
}

// Of the box, whose probe is without the kinetic part: the integral of stress times volume over the strains,
// by trapezoids. dL/L is the strain of the box of now.
double work_of_box(const Scene& scene, const Recorded& run) {
  double work = 0;
  for (const char axis : {'x', 'y', 'z'}) {
    const std::vector<double>& stress = values_of(run, fmt::format("box.{0}{0}", axis));
    const std::vector<double>& strain = values_of(run, fmt::format("box.strain_{}", axis));
    for (size_t k = 1; k < stress.size(); ++k) {
      const auto volume = [&](size_t step) { return scene.box_at(step).extent.prod(); };
      const double mean = (stress[k - 1] * volume(k - 1) + stress[k] * volume(k)) / 2;
      work += mean * std::log((1 + strain[k]) / (1 + strain[k - 1]));
    }
  }
  return work;
}

TEST(BoxDeform, LengthsAreAFunctionOfTheStep) {
  const Scene scene = deforming(lj_crystal("deform = { strain_rate = [0.1, 0, -0.05] }"));
  const double edge = std::sqrt(2.0) * scene.pitch;
  ASSERT_TRUE(scene.deforms());
  EXPECT_EQ(scene.box_at(0).extent, scene.periodic.extent);
  for (const uint64_t step : {1, 77, 300}) {
    const double time = static_cast<double>(step) * 0.004;
    const Vec3 extent = scene.box_at(step).extent;
    EXPECT_NEAR(extent[0], 4 * edge * (1 + 0.1 * time), 1e-13);
    EXPECT_EQ(extent[1], scene.periodic.extent[1]);
    EXPECT_NEAR(extent[2], 5 * edge * (1 - 0.05 * time), 1e-13);
  }
  const Scene total = deforming(lj_crystal("deform = { final_strain = [0.1, 0, 0] }"));
  EXPECT_NEAR(total.box_at(300).extent[0], 4 * edge * 1.1, 1e-13);
  EXPECT_NEAR(total.box_at(150).extent[0], 4 * edge * 1.05, 1e-13);
}

// One engine of the test: all pairs in their nearest images, velocity Verlet, and the box's affine motion
// before the drift.
struct ByHand {
  const Scene& scene;
  std::vector<Vec3> x, v, f;

  explicit ByHand(const Scene& of) : scene(of), x(of.body.x), v(of.body.v) { forces(0); }
  void forces(uint64_t step) {
    const Vec3 extent = scene.box_at(step).extent;
    f.assign(x.size(), Vec3::Zero());
    for (size_t i = 0; i < x.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        Vec3 d = x[j] - x[i];
        for (int a = 0; a < 3; ++a) d[a] -= extent[a] * std::round(d[a] / extent[a]);
        const double r = d.norm();
        if (r >= scene.rule.cutoff()) continue;
        const Vec3 push = scene.rule.law->force(r) / r * d;
        f[i] -= push, f[j] += push;
      }
  }
  void step(uint64_t number) {
    const double dt = scene.rule.dt;
    const Vec3 ratio = scene.box_at(number + 1).extent.cwiseQuotient(scene.box_at(number).extent);
    for (size_t i = 0; i < x.size(); ++i) {
      v[i] += f[i] * dt / 2;
      x[i] = ratio.cwiseProduct(x[i]) + v[i] * dt;
    }
    forces(number + 1);
    for (size_t i = 0; i < x.size(); ++i) v[i] += f[i] * dt / 2;
  }
};

TEST(BoxDeform, StepsAreThoseByHand) {
  const Scene scene = deforming(lj_crystal("deform = { strain_rate = [0.3, -0.1, 0] }", kWarmth));
  ByHand hand(scene);
  ReferenceEngine engine(scene, scene.body, {.integrator = Integrator::velocity_verlet}, 1);
  for (uint64_t step = 0; step < 100; ++step) hand.step(step);
  engine.advance(100, nullptr);
  double worst = 0;
  for (size_t i = 0; i < hand.x.size(); ++i)
    worst =
        std::max({worst, (hand.x[i] - engine.body().x[i]).norm(), (hand.v[i] - engine.body().v[i]).norm()});
  EXPECT_LT(worst, 1e-10);
}

// Lists that last over many steps leave no mark: an engine that is made anew at each step has the same bits,
// also where the box shrinks by a quarter, or particles meet their images across it.
TEST(BoxDeform, ListsAndNewBeginningsLeaveNoMark) {
  for (const char* rate : {"[-0.9, 0.4, 0]", "[0.5, 0.5, 0.5]", "[0, 0, -0.8]"}) {
    const Scene scene = deforming(lj_crystal(fmt::format("deform = {{ strain_rate = {} }}", rate), kWarmth,
                                             "dt = 0.002\nsteps = 100\n"));
    ReferenceEngine whole(scene, scene.body, {.threads = 2}, 1);
    Body body = scene.body;
    for (uint64_t step = 0; step < 100; ++step) {
      ReferenceEngine one(scene, body, {}, 1, step);
      one.advance(1, nullptr);
      EXPECT_EQ(one.step_count(), step + 1);
      body = one.body();
      whole.advance(1, nullptr);
      for (size_t i = 0; i < body.size(); ++i) {
        ASSERT_EQ(body.x[i], whole.body().x[i]) << rate << " step " << step << " particle " << i;
        ASSERT_EQ(body.v[i], whole.body().v[i]);
      }
    }
  }
}

// What the energy gains is the box's work. Velocity Verlet keeps energy to dt^2: 2e-4 of the kinetic energy
// here, and trapezoids err by the square of a step's strain.
TEST(BoxDeform, TheBoxDoesWork) {
  for (const char* rate : {"[0.1, 0, 0]", "[-0.05, 0, 0.04]"}) {
    const Scene scene = deforming(lj_crystal(fmt::format("deform = {{ strain_rate = {} }}", rate),
                                             kWarmth + stress_probe("virial = true\n")));
    const Recorded done = recorded(scene, {.integrator = Integrator::velocity_verlet});
    ASSERT_EQ(done.trace.steps_done, 300u);
    EXPECT_TRUE(done.trace.findings.empty()) << done.trace.findings[0].text;
    const std::vector<double>& energy = values_of(done, "energy.total");
    const double gained = energy.back() - energy.front(), work = work_of_box(scene, done);
    EXPECT_GT(std::abs(gained), 1);
    EXPECT_NEAR(work, gained, 2e-3 * std::abs(gained)) << rate;
  }
}

// C_aabb of a packing without pressure under central forces f(r): the sum over neighbours of
// (f/r - df/dr) d_a^2 d_b^2/r^2, over twice a particle's volume. M. Born and K. Huang (1954), section 29.
double central_constant(const Scene& scene, int a, int b) {
  const PairLaw& law = *scene.rule.law;
  double sum = 0;
  for (const Vec3& d : fcc_neighbours(scene.pitch, law.cutoff())) {
    const double r = d.norm();
    sum += (law.force(r) / r - law.slope(r)) * d[a] * d[a] * d[b] * d[b] / (r * r);
  }
  return sum / (2 * fcc_volume(scene.pitch));
}

TEST(BoxDeform, StaticLoadingFollowsTheConstants) {
  const Scene scene = deforming(lj_crystal("deform = { final_strain = [1e-4, 0, 0] }", stress_probe(""),
                                           "dt = 0.004\nsteps = 100\nstatic = { load_steps = 4 }\n"));
  const Recorded done = recorded(scene);
  ASSERT_FALSE(done.trace.stop) << done.trace.stop->text;
  const double c11 = central_constant(scene, 0, 0), c12 = central_constant(scene, 0, 1);
  const auto slope = [&](const char* name) {
    const std::vector<double>& stress = values_of(done, name);
    EXPECT_EQ(stress.size(), 5u);
    return (stress.back() - stress.front()) / 1e-4;
  };
  EXPECT_NEAR(values_of(done, "box.strain_x").back(), 1e-4, 1e-18);
  EXPECT_EQ(values_of(done, "box.strain_y").back(), 0);
  // The third-order constants make some 1e-3 of it at this strain.
  EXPECT_NEAR(slope("box.xx"), c11, 2e-3 * c11);
  EXPECT_NEAR(slope("box.yy"), c12, 2e-3 * c11);
  EXPECT_NEAR(slope("box.xy"), 0, 1e-6 * c11);
}

// Without the symmetry of a crystal particles move about the box's motion, and rest all the same; with a
// checkpoint's memory a run that goes on ends with the same bits.
TEST(BoxDeform, StaticLoadingRelaxesAndGoesOn) {
  const std::string vacancy =
      "[geometry]\nshape = \"difference\"\nfrom = { shape = \"box\", min = [-1, -1, -1], max = [9, 9, 9] }\n"
      "minus = [ { shape = \"sphere\", centre = [0, 0, 0], radius = 0.5 } ]\n";
  const Scene scene =
      deforming(lj_crystal("deform = { final_strain = [0.02, 0, 0] }", vacancy,
                           "dt = 0.004\nsteps = 100\nstatic = { load_steps = 5, tolerance = 1e-5 }\n"));
  ASSERT_EQ(scene.body.size(), 319u);
  StaticEngine whole(scene, scene.body, 1, 1);
  whole.advance(70, nullptr);  // within a load step
  const Body there = *whole.saved_body();
  StaticEngine on(scene, there, 1, 1, 70, whole.memory().own);
  whole.advance(30, nullptr), on.advance(30, nullptr);
  double moved = 0;
  const Vec3 ratio = scene.box_at(100).extent.cwiseQuotient(scene.periodic.extent);
  for (size_t i = 0; i < there.size(); ++i) {
    ASSERT_EQ(on.saved_body()->x[i], whole.saved_body()->x[i]);
    moved = std::max(moved, (ratio.cwiseProduct(scene.body.x[i]) - on.saved_body()->x[i]).norm());
  }
  EXPECT_GT(moved, 1e-3);
  const Reference at_rest(scene.rule, *on.saved_body(), scene.box_at(100));
  double left = 0;
  for (const Vec3& f : at_rest.forces()) left += f.norm();
  Mat3 sum = Mat3::Zero();
  for (const Mat3& of : at_rest.virial_stress(1)) sum += of;
  const double load = sum(0, 0) / scene.box_at(100).extent[0];
  EXPECT_LT(left, 1e-5 * load);
  EXPECT_GT(left, 1e-7 * load);  // by the tolerance of that load, not down to rounding
}

// A stage begins in the box that the one before it left, and so does a run from another's end: what would be
// too short from the box as packed may not be so from there.
TEST(BoxDeform, AStageIsNotJudgedByTheBoxAsPacked) {
  const std::string text =
      lj_crystal("",
                 "[[stage]]\nname = \"pull\"\nsteps = 200\ndeform = { final_strain = [0.4, 0, 0] }\n"
                 "[[stage]]\nname = \"back\"\nsteps = 200\ndeform = { strain_rate = [-0.5, 0, 0] }\n");
  Scene back = parse_scene(text, "a.toml", {.begins = true, .stage = "back"});
  EXPECT_NEAR(back.deform->strain_at(200)[0], -0.4, 1e-9);
  begin_box(back, Vec3(0.4, 0, 0));
  EXPECT_NEAR(back.deform->strain_at(200)[0], 0, 1e-9);
  EXPECT_NE(refused_with([&] { begin_box(back, Vec3::Zero()); }).find("less than two cutoffs"),
            std::string::npos);
  const std::string alone =
      lj_crystal("deform = { strain_rate = [-0.5, 0, 0] }", "", "dt = 0.004\nsteps = 200\n");
  EXPECT_NE(refused(alone).find("less than two cutoffs"), std::string::npos);
  EXPECT_NO_THROW(deforming("start = { from = \"there\" }\n" + alone));
}

TEST(StressProbe, IsThePressureTensorAndTheSumOfRegions) {
  const std::string left = "region = { shape = \"half_space\", point = [2, 0, 0], normal = \"x\" }\n",
                    right = "region = { shape = \"half_space\", point = [1.999, 0, 0], normal = \"-x\" }\n";
  const Scene scene = deforming(lj_crystal(
      "",
      kWarmth + stress_probe("") + stress_probe("virial = true\n", "virial") + stress_probe(left, "left") +
          stress_probe(right, "right") + stress_probe(left + "volume = 2\n", "given"),
      "dt = 0.004\nsteps = 20\nprobe_every = 10\nenergy_every = 10\n"));
  const Recorded done = recorded(scene);
  const double volume = scene.periodic.extent.prod();
  const double n = static_cast<double>(scene.body.size());
  const double there = static_cast<double>(scene.probes[2].set.ids.size());
  ASSERT_EQ(there + static_cast<double>(scene.probes[3].set.ids.size()), n);
  ASSERT_GT(there, 10);
  for (size_t k = 0; k < 3; ++k) {
    const auto at = [&](const std::string& name) { return values_of(done, name).at(k); };
    const double p = at("pressure"), kinetic = at("energy.kinetic");
    EXPECT_NEAR(at("box.xx") + at("box.yy") + at("box.zz"), -3 * p, 1e-11);
    EXPECT_NEAR(at("virial.xx") + at("virial.yy") + at("virial.zz"), -3 * p + 2 * kinetic / volume, 1e-11);
    for (const char* component : {"xx", "yy", "zz", "xy", "xz", "yz"}) {
      const std::string of = std::string(".") + component;
      // Each region has its share of the volume.
      EXPECT_NEAR(at("left" + of) * there / n + at("right" + of) * (1 - there / n), at("box" + of), 1e-11);
      EXPECT_NEAR(at("given" + of) * 2, at("left" + of) * volume * there / n, 1e-9);
    }
  }
  EXPECT_GT(std::abs(values_of(done, "box.xy").back()), 1e-4);
}

// Engines of integers read it by the law in doubles at their positions.
TEST(StressProbe, OfIntegersIsThatOfDoubles) {
  const Scene scene =
      deforming(lj_crystal("", kWarmth + stress_probe("") + stress_probe("virial = true\n", "virial"),
                           "dt = 0.004\nsteps = 10\nprobe_every = 5\n"));
  const Plan plan = plan_of(scene, Arch{}, CellForm::any);
  RunRequest request;
  request.steps = scene.steps;
  request.probes = {0, 5, 10};
  request.energies = true;
  const Recorded fixed = record(scene, golden_kind(scene, plan), request), real = recorded(scene);
  for (const char* name : {"box.xx", "box.zz", "box.yz", "virial.xx", "virial.xy", "box.strain_x"})
    for (size_t k = 0; k < 3; ++k)
      // Forces of the table and velocities are rounded; positions of the tenth step by less.
      EXPECT_NEAR(values_of(fixed, name)[k], values_of(real, name)[k], 2e-4) << name << ' ' << k;
  EXPECT_GT(std::abs(values_of(real, "box.xx")[1]), 0.05);
}

TEST(BoxDeform, IsRefusedWithItsPlace) {
  EXPECT_EQ(refused(lj_crystal("deform = { strain_rate = [0.1, 0, 0], final_strain = [1, 0, 0] }")),
            "a.toml:8:54: give 'strain_rate' or 'final_strain', not both");
  EXPECT_EQ(refused(lj_crystal("deform = true")),
            "a.toml:8:10: 'deform' needs a table of strain rates or of strains, or false\n"
            "  hint: deform = { final_strain = [0.1, 0, 0] }");
  EXPECT_EQ(refused(lj_crystal("deform = { final_strain = [0, -1, 0] }")),
            "a.toml:8:27: a strain of -1 or less leaves no box");
  EXPECT_EQ(refused(lj_crystal("deform = { strain_rate = [-1, 0, 0] }")),
            "a.toml:8:10: at step 90, strained by -0.36 along x, the box is 3.98493 m long: less than two "
            "cutoffs (4 m)\n"
            "  hint: a longer box, or a smaller strain");
  EXPECT_EQ(refused(lj_crystal("deform = { erate = [1, 0, 0] }")),
            "a.toml:8:12: unknown key 'erate'\n"
            "  hint: deform = { strain_rate = ... } or deform = { final_strain = ... } changes the lengths");
  const std::string pulled = "deform = { strain_rate = [0.1, 0, 0] }";
  EXPECT_EQ(refused_with([&] { parse_scene(lj_crystal(pulled), "a.toml"); }),
            "a.toml:8:10: a box that deforms is for 'cuboct run' and 'check'\n"
            "  hint: this command takes a box of one size");
  std::string slab = lj_crystal("deform = { strain_rate = [0, 0, 0.1] }");
  slab.replace(slab.find("\"xyz\""), 5, "\"xy\"");
  EXPECT_EQ(refused(slab),
            "a.toml:8:26: the box does not repeat along z: there is no length to change\n"
            "  hint: moved and pulled regions strain a body with faces");
  EXPECT_EQ(refused(lj_crystal(pulled,
                               "[[probe]]\nname = \"c\"\nkind = \"crack\"\naxis = \"x\"\n"
                               "region = { shape = \"box\", size = [9, 9, 9] }\n")),
            "a.toml:16:8: a crack probe counts bonds of the packing, in a box of one size");
  const Scene scene = deforming(lj_crystal(pulled));
  EXPECT_EQ(refused_with([&] { recorded(scene, {.precision = Precision::float32}); }),
            "floats do not hold the strain of one step: a box that deforms needs doubles\n"
            "  hint: leave --precision out");
  EXPECT_EQ(refused_with([&] { check_runs(scene, {}, "lattice"); }),
            "a.toml:8:10: a box that deforms is not for the lattice engine\n"
            "  hint: --engine reference carries its particles along");
  // Beyond the scene's steps.
  const Scene pressed = deforming(lj_crystal("deform = { strain_rate = [-0.2, 0, 0] }"));
  ReferenceEngine engine(pressed, pressed.body, {}, 1, 440);
  EXPECT_EQ(
      refused_with<StepError>([&] { engine.advance(1000, nullptr); }),
      "at step 447, strained by -0.3576 along x, the box is 3.99987 m long: less than two cutoffs (4 m)");
  EXPECT_EQ(engine.step_count(), 446u);
}

TEST(StressProbe, IsRefusedWithItsPlace) {
  std::string slab = lj_crystal("", stress_probe(""));
  slab.replace(slab.find("\"xyz\""), 5, "\"xy\"");
  EXPECT_GT(deforming(slab).probes[0].volume, 0);  // that of the packing
  EXPECT_EQ(
      refused(lj_crystal("", stress_probe("accuracy = 0.01\n"))),
      "a.toml:17:12: stress is that of all particles, by the law in doubles: no accuracy is asked of it");
  EXPECT_EQ(refused(lj_crystal("", stress_probe("volume = -1\n"))),
            "a.toml:17:10: 'volume' must be greater than 0, not -1");
}

}  // namespace
}  // namespace cuboct
