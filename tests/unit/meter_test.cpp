// SPDX-License-Identifier: MIT
// The curves of runs in real numbers: by hand, and beside those of the fixed rule.
#include "model/analysis/meter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hw/engine/engine_kind.h"
#include "hw/engine/scene_engine.h"
#include "model/contract/law.h"
#include "tests/fcc_block.h"

namespace cuboct {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

// One particle of 2 kg on a controller, kp = 7 N/m, kd = 3 kg/s, that follows 0.5 m/s. It goes at 1.5 m/s and
// lags by 0.2 m; gravity is -4 m/s^2: a = -(7*0.2 + 3*1)/2 - 4 = -6.2 m/s^2.
Scene one_particle() {
  Scene scene;
  scene.rule = test::simple_rule(preset_law("elastic", 1, 1), 2, 0.1);
  ParticleType& type = scene.rule.types[0];
  type.pd = true;
  type.kp = 7, type.kd = 3;
  type.velocity = Vec3(0.5, 0, 0);
  type.gravity = Vec3(-4, 0, 0);
  scene.body.x = {Vec3(10, 0, 0)};
  scene.body.v = {Vec3(1.5, 0, 0)};
  scene.body.u = {Vec3(0.2, 0, 0)};
  scene.body.type = {0};
  return scene;
}

TEST(Meter, EnergiesOfAParticleHeldByForce) {
  const Scene scene = one_particle();
  for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::velocity_verlet}) {
    const Reference reference(scene.rule, scene.body, scene.periodic, integrator);
    Meter meter(scene, [&](uint32_t id) { return scene.body.x[id]; }, {.energies = true});
    const double late = integrator == Integrator::semi_implicit_euler ? scene.rule.dt / 2 : 0;
    meter.add(read_reference(scene.rule, reference, late, meter.asked({}, true, reference.step_count())), {});
    const std::vector<Curve> curves = meter.curves();
    ASSERT_EQ(curves.size(), 4u);
    // Velocities of semi-implicit Euler live half a step earlier.
    const double v = integrator == Integrator::semi_implicit_euler ? 1.5 - 6.2 * 0.05 : 1.5;
    EXPECT_NEAR(curves[0].value[0], v * v, 1e-12);
    EXPECT_EQ(curves[1].value[0], 0);
    EXPECT_NEAR(curves[2].value[0], 2 * 4 * 10, 1e-12);
    EXPECT_NEAR(curves[3].value[0], v * v + 80, 1e-12);
  }
}

// The same names, units and, but for rounding and the table's error, values as those of the fixed rule: warm
// in a box that repeats, and held by controllers under gravity.
TEST(Meter, IsThatOfTheFixedRule) {
  for (const char* name : {"lj_block", "failures/stiff_hold_healthy"}) {
    const Scene scene = read_scene(kRoot + "/scenes/" + name + ".toml");
    const Plan plan = plan_of(scene, {});
    RunRequest request;
    request.steps = 20;
    request.probes = {20};
    request.energies = true;
    const std::vector<Curve> a = record(scene, golden_kind(scene, plan), request).trace.curves,
                             b = record(scene, scene_reference_kind(scene, plan, {}), request).trace.curves;
    ASSERT_EQ(a.size(), b.size()) << name;
    for (size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].name, b[k].name);
      EXPECT_EQ(a[k].unit, b[k].unit);
      EXPECT_EQ(a[k].step, b[k].step);
      EXPECT_NEAR(a[k].value[0], b[k].value[0], 5e-3 * std::abs(b[k].value[0])) << name << ' ' << a[k].name;
    }
    // Behind the probes' curves; the second scene's box does not repeat.
    std::vector<std::string> names{"energy.kinetic", "energy.potential", "energy.gravity", "energy.total",
                                   "temperature"};
    if (name == std::string("lj_block")) names.push_back("pressure");
    ASSERT_GE(a.size(), names.size());
    const size_t first = a.size() - names.size();
    for (size_t k = 0; k < names.size(); ++k) EXPECT_EQ(a[first + k].name, names[k]);
    EXPECT_GT(b[first].value[0], 0);  // it moves
  }
}

}  // namespace
}  // namespace cuboct
