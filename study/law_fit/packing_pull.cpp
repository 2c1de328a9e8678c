// SPDX-License-Identifier: MIT
#include "study/law_fit/packing_pull.h"

#include <Eigen/Cholesky>

#include "model/solid/dynamical_matrix.h"

namespace cuboct::fit {
namespace {

// With the energy 1/2 sum U(r) per particle, r^2 = sum (s_a d_a)^2 over the stretches s and bonds d at rest,
// the stresses over areas at rest are P_a = -1/(2V) sum f s_a d_a^2/r, and
//   dP_a/ds_b = -1/(2V) sum [(f' - f/r)/r^2 s_a d_a^2 s_b d_b^2 + e_ab f/r d_a^2],  e Kronecker's symbol.
struct Stresses {
  Vec3 p = Vec3::Zero();
  Mat3 slope = Mat3::Zero();
};

Stresses stresses(const PairLaw& law, const std::vector<Vec3>& bonds, const Vec3& stretch) {
  Stresses out;
  for (const Vec3& d : bonds) {
    const double r = stretch.cwiseProduct(d).norm();
    if (r >= law.cutoff()) continue;
    const double f = law.force(r);
    const Vec3 square = d.cwiseAbs2(), w = stretch.cwiseProduct(square);
    out.p -= f / r * w;
    out.slope -= (law.slope(r) - f / r) / (r * r) * w * w.transpose();
    out.slope.diagonal() -= eigen(f / r * square);
  }
  return out;
}

// Newton's method; where the sides find no rest, the stretch of the last step is as good as any.
void free_sides(const PairLaw& law, const std::vector<Vec3>& bonds, Vec3& stretch) {
  constexpr int kSteps = 20;
  constexpr double kLargest = 0.01, kSmallest = 1e-7;  // changes of a stretch
  for (int k = 0; k < kSteps; ++k) {
    const Stresses now = stresses(law, bonds, stretch);
    const Eigen::Vector2d move = now.slope.bottomRightCorner<2, 2>().ldlt().solve(-eigen(now.p).tail<2>());
    const double size = move.cwiseAbs().maxCoeff();
    if (!(size > kSmallest)) return;
    eigen(stretch).tail<2>() += size > kLargest ? Eigen::Vector2d(kLargest / size * move) : move;
  }
}

}  // namespace

std::vector<double> packing_stress(const PairLaw& law, double pitch, const Mat3& axes,
                                   const std::vector<double>& strains) {
  // Sides that narrow bring bonds into the law's range.
  std::vector<Vec3> bonds = fcc_neighbours(pitch, 1.3 * law.cutoff());
  for (Vec3& d : bonds) d = axes.transpose() * d;
  const double volume = fcc_volume(pitch);
  std::vector<double> out;
  Vec3 stretch = Vec3::Ones();
  for (const double strain : strains) {
    stretch[0] = 1 + strain;
    free_sides(law, bonds, stretch);
    out.push_back(stresses(law, bonds, stretch).p[0] / (2 * volume));
  }
  return out;
}

}  // namespace cuboct::fit
