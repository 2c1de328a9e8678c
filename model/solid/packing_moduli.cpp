// SPDX-License-Identifier: MIT
#include <Eigen/LU>

#include "model/solid/dynamical_matrix.h"

namespace cuboct {

Matrix6 elastic_constants(const PairLaw& law, double pitch) {
  Matrix6 c = Matrix6::Zero();
  for (const Vec3& d : fcc_neighbours(pitch, law.cutoff())) {
    const double r = d.norm();
    const double factor = (-law.slope(r) + law.force(r) / r) / (r * r) / (2 * fcc_volume(pitch));
    for (int a = 0; a < 6; ++a) {
      for (int b = 0; b < 6; ++b) {
        c(a, b) += factor * d[kVoigt[a][0]] * d[kVoigt[a][1]] * d[kVoigt[b][0]] * d[kVoigt[b][1]];
      }
    }
  }
  // From derivatives by Lagrangian strain to stress-strain coefficients under the stress -p: Wallace (2.36).
  const double p = fcc_pressure(law, pitch);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) c(a, b) += a == b ? -p : p;
    c(a + 3, a + 3) -= p;
  }
  return c;
}

double youngs_modulus(const Matrix6& c, const Vec3& direction) {
  const Vec3 n = direction.normalized();
  Eigen::Matrix<double, 6, 1> stress, along;  // n n^T, and what takes the normal strain out of a Voigt strain
  for (int a = 0; a < 6; ++a) stress[a] = along[a] = n[kVoigt[a][0]] * n[kVoigt[a][1]];
  return 1 / along.dot(c.fullPivLu().solve(stress));
}

}  // namespace cuboct
