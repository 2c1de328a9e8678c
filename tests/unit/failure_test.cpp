// SPDX-License-Identifier: MIT
// A small bar of each preset is pulled along <100> until long after it gave way: the presets fail as their
// names say.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/contract/law.h"
#include "model/real/reference.h"
#include "tests/fcc_block.h"

namespace cuboct {
namespace {

struct Pull {
  double strength = 0;  // the largest stress, in stiffness/pitch
  double left = 0;      // the mean stress between 18 % and 25 % strain, over the strength
};

Pull pull(const char* name) {
  constexpr int kWide = 2, kLong = 6;  // cubic cells
  const double edge = std::numbers::sqrt2, length = kLong * edge;
  const Body block = test::fcc_block(kLong + 1, 1);
  Body body;
  for (const Vec3& x : block.x) {
    if (x.maxCoeff() < length + 0.1 && x.x() < kWide * edge + 0.1 && x.y() < kWide * edge + 0.1)
      body.x.push_back(x);
  }
  for (const Vec3& x : body.x) body.type.push_back(x.z() < 0.8 ? 1 : x.z() > length - 0.8 ? 2 : 0);
  body.v.assign(body.size(), Vec3::Zero());
  test::shake(body, 1e-4, 0, 3);

  Rule rule = test::simple_rule(preset_law(name, 1, 1), 1, 0.1);
  rule.damping.coefficient = 4;
  rule.types.resize(3);
  rule.types[1].imposed = rule.types[2].imposed = {true, true, true};
  rule.types[2].velocity = Vec3(0, 0, 5e-3);  // the speed of sound is about 1

  Reference run(rule, body, {}, Integrator::semi_implicit_euler);
  const double per_step = rule.types[2].velocity.z() * rule.dt / length;
  const double area = std::pow((kWide + 0.5) * edge, 2);
  Pull result;
  int late = 0;
  for (double strain = 0; strain < 0.25; strain = static_cast<double>(run.step_count()) * per_step) {
    run.step(20);
    const std::vector<Vec3> f = run.forces();
    double grip = 0;
    for (size_t i = 0; i < f.size(); ++i) grip -= body.type[i] == 2 ? f[i].z() : 0;
    result.strength = std::max(result.strength, grip / area);
    if (strain > 0.18) result.left += grip / area, ++late;
  }
  result.left /= late * result.strength;
  return result;
}

TEST(Failure, PresetsFailAsTheirNamesSay) {
  const Pull elastic = pull("elastic"), brittle = pull("brittle"), ductile = pull("ductile"),
             viscous = pull("viscous");
  EXPECT_GT(elastic.strength, 1.2 * ductile.strength);
  EXPECT_GT(ductile.strength, 1.2 * brittle.strength);
  EXPECT_GT(brittle.strength, 1.2 * viscous.strength);
  EXPECT_LT(std::abs(brittle.left), 0.05);  // parted; the halves still ring
  EXPECT_GT(ductile.left, 0.25);
  EXPECT_GT(elastic.left, 0.5);
}

}  // namespace
}  // namespace cuboct
