// SPDX-License-Identifier: MIT
#include "study/law_fit/cheap_case.h"

#include <Eigen/Geometry>

#include "model/base/mat3.h"
#include "model/scene/scene_parts.h"

namespace cuboct::fit {

LawScale cheap_scale(const Target& target, const Scene& scene, const Vec3& axis, double reach) {
  const double k = stiffness_from_modulus(target.modulus, scene.orientation.transpose() * axis, scene.pitch);
  return {scene.pitch, reach, k, k * scene.pitch * target.strength / target.modulus};
}

Parameters cheap_start(const Target& target, const LawScale& scale) {
  Parameters p{};
  p[stiffness] = 1;
  p[push_top] = 0.4;
  p[push_1] = p[push_2] = 0.5;
  p[push_2_force] = 0.9;
  p[push_3] = 0.1;
  p[pull_1] = 0.8;
  p[pull_2_force] = p[pull_3_force] = 1;
  p[pull_4_force] = -0.1;
  // Q2 at a third of the yield strain, Q3 a little beyond it, Q4 half of the way from there to the reach.
  const double outer = 1 + p[pull_1] * scale.height / (scale.stiffness * scale.pitch);
  const double q2 = 1 + 0.35 * target.yield_strain, q3 = 1 + 1.2 * target.yield_strain;
  p[pull_2] = (q2 - outer) / (scale.reach - outer);
  p[pull_3] = (q3 - q2) / (scale.reach - q2);
  p[pull_4] = 0.5;
  return p;
}

Mat3 pull_axes(const Scene& scene, const Vec3& axis) {
  Eigen::Index nearest = 0;
  axis.cwiseAbs().maxCoeff(&nearest);
  const Vec3 side = axis.cross(Vec3::Unit((nearest + 1) % 3)).normalized();
  Mat3 axes;
  axes << eigen(axis.normalized()), eigen(side), eigen(axis.normalized().cross(side));
  return scene.orientation.transpose() * axes;
}

}  // namespace cuboct::fit
