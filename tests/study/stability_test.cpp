// SPDX-License-Identifier: MIT
// The largest stable time step, measured by bisection on the engines, against the theory of small vibrations.
#include "study/stability/stability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/base/error.h"
#include "model/contract/law.h"
#include "model/solid/dynamical_matrix.h"
#include "study/stability/stability_map.h"
#include "tests/fcc_block.h"
#include "tests/support/refused_with.h"

namespace cuboct::study {
namespace {

constexpr double kStiffness = 5, kMass = 3;

Scene block(int cells, std::shared_ptr<const PairLaw> law, bool periodic = false) {
  Scene scene;
  scene.pitch = 1;
  scene.rule = test::simple_rule(std::move(law), kMass, 0.01);
  scene.body = test::fcc_block(cells, 1);
  if (periodic) scene.periodic = test::fcc_box(cells, 1);
  return scene;
}

struct AskedPoint {
  const char* name;
  Method method;
};
const std::vector<AskedPoint>& methods() {
  static const std::vector<AskedPoint> all{
      {"Euler", {Arithmetic::float64, Integrator::semi_implicit_euler}},
      {"Verlet", {Arithmetic::float64, Integrator::velocity_verlet}},
      {"Euler in floats", {Arithmetic::float32, Integrator::semi_implicit_euler}},
      {"Verlet in floats", {Arithmetic::float32, Integrator::velocity_verlet}},
      {"Euler, fixed", {Arithmetic::fixed, Integrator::semi_implicit_euler}}};
  return all;
}

// Half of a bracket of 0.5 % is 0.25 %. In floats and integers the law has softened or stiffened by the swing
// that stands out of their rounding, and rounding keeps pushing a damped body: 1 % more.
void expect_as_predicted(const Subject& subject, const Arch& arch = {}) {
  ASSERT_TRUE(subject.measurable) << subject.note;
  for (const AskedPoint& asked : methods()) {
    const MeasuredLimit measured = measured_limit(subject, arch, asked.method, 0.005);
    EXPECT_FALSE(measured.refused) << asked.name << ": " << measured.sign;
    EXPECT_LE(measured.unstable, 1.00501 * measured.stable) << asked.name;
    EXPECT_NEAR(measured.middle() / subject.limit.dt, 1,
                asked.method.arithmetic == Arithmetic::float64 ? 0.003 : 0.013)
        << asked.name << ", " << measured.sign;
  }
}

TEST(Stability, PerfectPeriodicBlock) {
  const Scene scene = block(4, preset_law("elastic", 1, kStiffness), true);
  const Subject subject = subject_of(scene);
  EXPECT_NEAR(subject.limit.dt, 2 / std::sqrt(8 * kStiffness / kMass), 1e-6);
  expect_as_predicted(subject);
}

TEST(Stability, FreeBody) {
  const Subject subject = subject_of(block(2, preset_law("ductile", 1, kStiffness)));
  // Fewer bonds than in the packing.
  EXPECT_GT(subject.limit.dt, 1.05 * 2 / std::sqrt(8 * kStiffness / kMass));
  expect_as_predicted(subject);
}

TEST(Stability, Damped) {
  double before = 1;
  for (const double ratio : {0.05, 0.4, 1.5}) {
    Scene scene = block(2, preset_law("elastic", 1, kStiffness));
    scene.rule.damping.coefficient = ratio * 2 * std::sqrt(kStiffness * kMass);
    const Subject subject = subject_of(scene);
    const double share = 1 - subject.limit.damping_share;
    EXPECT_LT(share, 0.97 * before) << ratio;
    before = share;
    expect_as_predicted(subject);
  }
}

TEST(Stability, TypesOfUnlikeStrength) {
  Scene scene = block(2, preset_law("elastic", 1, kStiffness));
  scene.rule.types.resize(2);
  scene.rule.types[1].material = 1;
  scene.rule.strength = {{1, 1.7}, {1.7, 4}};
  for (size_t i = 0; i < scene.body.size(); ++i) scene.body.type[i] = scene.body.x[i].x() > 1.2;
  const Subject subject = subject_of(scene);
  const Subject alike = subject_of(with_parts(scene, {.strengths = false}));
  EXPECT_LT(subject.limit.dt, 0.7 * alike.limit.dt);
  EXPECT_GT(subject.limit.dt, 0.5 * alike.limit.dt);  // 1/sqrt(4), were all as the stronger
  expect_as_predicted(subject);
}

// One face held, the other moved along z alone; its velocity and gravity play no part in small motions.
TEST(Stability, HeldAndMoved) {
  Scene scene = block(2, preset_law("elastic", 1, kStiffness));
  scene.rule.types.resize(3);
  scene.rule.types[1].imposed = {true, true, true};
  scene.rule.types[2].imposed = {false, false, true};
  scene.rule.types[2].velocity = Vec3(0, 0, 0.3);
  for (ParticleType& type : scene.rule.types) type.gravity = Vec3(0, 0, -0.01);
  for (size_t i = 0; i < scene.body.size(); ++i)
    scene.body.type[i] = scene.body.x[i].z() < 0.1 ? 1 : scene.body.x[i].z() > 2 ? 2 : 0;
  const Subject subject = subject_of(scene);
  EXPECT_NE(subject.limit.dt, subject_of(with_parts(scene, {.imposed = false})).limit.dt);
  expect_as_predicted(subject);
}

TEST(Stability, HeldByForce) {
  Scene scene = block(2, preset_law("elastic", 1, kStiffness));
  scene.rule.types.resize(2);
  scene.rule.types[1].pd = true;
  scene.rule.types[1].kp = 10 * kStiffness;
  for (size_t i = 0; i < scene.body.size(); ++i) scene.body.type[i] = scene.body.x[i].z() < 0.1;
  const Subject subject = subject_of(scene);
  EXPECT_LT(subject.limit.dt, 0.8 * subject_of(with_parts(scene, {.pd = false})).limit.dt);
  Arch wide;
  wide.widths.gain_frac = 14;  // gains below 8: kp dt^2/m is near 3 at the limit
  expect_as_predicted(subject, wide);
  Scene with_kd = scene;
  with_kd.rule.types[1].kd = 1.5;
  const Subject slowed = subject_of(with_kd);
  EXPECT_LT(slowed.limit.dt, 0.97 * subject.limit.dt);
  expect_as_predicted(slowed, wide);
  // With 16 fractional bits gains are below 2: it ends before stability does, and says so.
  Arch narrow;
  narrow.widths.gain_frac = 16;
  const MeasuredLimit refused = measured_limit(subject, narrow, {Arithmetic::fixed}, 0.005);
  EXPECT_TRUE(refused.refused);
  EXPECT_NE(refused.sign.find("the gain kp"), std::string::npos) << refused.sign;
  EXPECT_LT(refused.unstable, 0.95 * subject.limit.dt);
  EXPECT_NEAR(scene.rule.types[1].kp * std::pow(refused.unstable, 2) / kMass, 2, 0.03);
}

TEST(Stability, StretchedByTenPerCent) {
  const Scene scene = block(2, preset_law("elastic", 1, kStiffness));
  const Subject subject = subject_of(scene, 0, 0.1);
  EXPECT_NEAR(subject.scene.body.x.back().x(), 1.1 * scene.body.x.back().x(), 1e-12);
  EXPECT_EQ(subject.scene.body.x.back().y(), scene.body.x.back().y());
  EXPECT_NE(subject.limit.dt, subject_of(scene).limit.dt);
  // Held by constant forces, the surface's types differ.
  EXPECT_GT(subject.scene.rule.types.size(), 5U);
  expect_as_predicted(subject);
}

// Lennard-Jones stiffens: pressed by 10 % the limit is two thirds. A periodic box that is pressed has no cell
// edge that divides it, so this is measured in real numbers.
TEST(Stability, PressedByTenPerCent) {
  const auto law = lennard_jones(1, 1, 1.8, 0.8);
  Scene scene = block(3, law, true);
  const double pitch = relaxed_pitch(*law, 1.1);
  scene.pitch = pitch;
  scene.body = test::fcc_block(3, pitch);
  scene.periodic = test::fcc_box(3, pitch);
  const Subject rest = subject_of(scene), pressed = subject_of(scene, 2, -0.1);
  EXPECT_NEAR(pressed.scene.periodic.extent.z(), 0.9 * scene.periodic.extent.z(), 1e-12);
  EXPECT_NEAR(pressed.limit.dt / rest.limit.dt, 0.67, 0.03);
  for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::velocity_verlet}) {
    const MeasuredLimit measured = measured_limit(pressed, Arch{}, {Arithmetic::float64, integrator}, 0.005);
    EXPECT_NEAR(measured.middle() / pressed.limit.dt, 1, 0.003);
  }
  EXPECT_THROW(measured_limit(pressed, Arch{}, {Arithmetic::fixed}, 0.005), InputError);
}

TEST(Stability, ALennardJonesSurfaceIsRelaxedFirst) {
  const auto law = lennard_jones(1, 1, 1.8, 0.8);
  Scene scene = block(2, law);
  scene.pitch = relaxed_pitch(*law, 1.1);
  scene.body = test::fcc_block(2, scene.pitch);
  const Subject subject = subject_of(scene);
  EXPECT_EQ(subject.note.rfind("relaxed first: particles moved by up to ", 0), 0U) << subject.note;
  EXPECT_FALSE(subject.limit.body_unstable());
  expect_as_predicted(subject);
}

TEST(Stability, NoStepCuresABodyThatBuckles) {
  const Subject subject = subject_of(block(2, preset_law("elastic", 1, kStiffness)), 0, -0.1);
  EXPECT_FALSE(subject.measurable);
  EXPECT_TRUE(subject.limit.body_unstable());
  EXPECT_EQ(subject.note, "the body itself is unstable: no dt cures that");
}

// Runs far from the limit: at ten times it a body is gone within the first steps; far below, it only swings.
TEST(Stability, VerdictsFarFromTheLimit) {
  const Subject subject = subject_of(block(2, preset_law("elastic", 1, kStiffness)));
  const uint64_t steps = steps_to_tell(subject.limit, 0.01);
  for (const AskedPoint& asked : methods()) {
    for (const double part : {0.02, 0.1, 0.5, 0.98})
      EXPECT_EQ(try_step(subject, Arch{}, asked.method, part * subject.limit.dt, 0.01, steps).verdict,
                TrialVerdict::stable)
          << asked.name << " at " << part;
    for (const double part : {1.02, 1.1, 1.5, 3.0, 10.0}) {
      const Trial trial = try_step(subject, Arch{}, asked.method, part * subject.limit.dt, 0.01, steps);
      EXPECT_NE(trial.verdict, TrialVerdict::stable) << asked.name << " at " << part;
      EXPECT_FALSE(trial.sign.empty());
    }
  }
}

TEST(Stability, MapsAgreeWithTheTheory) {
  const Scene scene = block(2, preset_law("elastic", 1, kStiffness));
  int cells = 0, refused = 0, unstable_bodies = 0;
  Arch narrow;  // whose gains end before stability does
  narrow.widths.gain_frac = 16;
  const std::vector<StabilityMap> maps =
      stability_maps(scene, narrow, 0, 4, [](const std::string&, double) {});
  ASSERT_EQ(maps.size(), 6U);
  for (const StabilityMap& map : maps)
    for (size_t k = 0; k < map.y.size(); ++k)
      for (size_t i = 0; i < map.x.size(); ++i) {
        const StabilityMap::Cell cell = map.cells[k * map.x.size() + i];
        refused += cell == StabilityMap::Cell::refused;
        unstable_bodies += cell == StabilityMap::Cell::body_unstable;
        if (cell > StabilityMap::Cell::unstable || std::abs(map.y[k] / map.theory[i] - 1) < 0.05) continue;
        EXPECT_EQ(cell == StabilityMap::Cell::stable, map.y[k] < map.theory[i])
            << map.name << " " << map.x[i] << " " << map.y[k];
        ++cells;
      }
  EXPECT_GT(cells, 60);
  EXPECT_GT(refused, 3);
  EXPECT_GT(unstable_bodies, 3);  // pressed ones
}

TEST(Stability, MapsAreOfSmallScenes) {
  Scene scene = block(2, preset_law("elastic", 1, kStiffness));
  scene.body = test::fcc_block(11, 1);
  EXPECT_EQ(refused_with([&] { check_maps(scene); }),
            "--maps runs a scene thousands of times: 5324 particles are more than 5000\n"
            "  hint: draw them of a smaller piece");
}

}  // namespace
}  // namespace cuboct::study
