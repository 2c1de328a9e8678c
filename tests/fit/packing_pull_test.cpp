// SPDX-License-Identifier: MIT
#include "study/law_fit/packing_pull.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "model/contract/law.h"
#include "model/solid/dynamical_matrix.h"

namespace cuboct::fit {
namespace {

Mat3 along(const Vec3& pull, const Vec3& side) {
  Mat3 axes;
  axes << eigen(pull.normalized()), eigen(side.normalized()),
      eigen(pull.normalized().cross(side.normalized()));
  return axes;
}

TEST(PackingPull, BeginsWithYoungsModulus) {
  const double pitch = 1e-3;
  const auto law = preset_law("elastic", pitch, 1e6);
  const Matrix6 constants = elastic_constants(*law, pitch);
  for (const auto& [pull, side] : {std::pair{Vec3(1, 0, 0), Vec3(0, 1, 0)},
                                   {Vec3(1, 1, 0), Vec3(0, 0, 1)},
                                   {Vec3(1, 1, 1), Vec3(1, -1, 0)}}) {
    const double strain = 1e-5;
    const double modulus = packing_stress(*law, pitch, along(pull, side), {0, strain})[1] / strain;
    EXPECT_NEAR(modulus / youngs_modulus(constants, pull), 1, 1e-3);
  }
}

// Pulled along [110] rows of bonds carry all of the load, each over the area pitch^2/sqrt(2): all other bonds
// can keep their length, where the law ends before second neighbours.
TEST(PackingPull, IsThePullOfTheRowsAlong110) {
  const double pitch = 1e-3, strain = 0.05;
  const auto law = spline_law({0.5 * pitch, pitch, 1.2 * pitch, 1.3 * pitch}, {500, 0, -120, 0},
                              Interpolation::monotone_cubic, 0.5 * pitch);
  const double stress = packing_stress(*law, pitch, along({1, 1, 0}, {0, 0, 1}), {0, 0.02, strain})[2];
  EXPECT_NEAR(stress / (-law->force(pitch * (1 + strain)) * std::sqrt(2.0) / (pitch * pitch)), 1, 1e-6);
}

}  // namespace
}  // namespace cuboct::fit
