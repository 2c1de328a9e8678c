// SPDX-License-Identifier: MIT
#include "model/solid/dynamical_matrix.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "model/base/error.h"

namespace cuboct {
namespace {

// A neighbour and what its bond does for small displacements: the force constants are
// `axial` e e^T + `lateral` (1 - e e^T), axial = U'' = -df/dr, lateral = U'/r = -f/r, in N/m.
struct Bond {
  Vec3 d;
  Mat3 constants;
};

// One of each pair of opposite neighbours.
std::vector<Bond> half_bonds(const PairLaw& law, double pitch) {
  std::vector<Bond> bonds;
  for (const Vec3& d : fcc_neighbours(pitch, law.cutoff())) {
    const bool upper = d.z() > 0 || (d.z() == 0 && (d.y() > 0 || (d.y() == 0 && d.x() > 0)));
    if (!upper) continue;
    const double r = d.norm();
    const double axial = -law.slope(r), lateral = -law.force(r) / r;
    const Vec3 e = d / r;
    bonds.push_back({d, lateral * Mat3::Identity() + (axial - lateral) * (e * e.transpose())});
  }
  return bonds;
}

// m D(q) = sum over all neighbours of constants * (1 - cos q.d); opposite ones contribute the same.
Vec3 eigenvalues(const std::vector<Bond>& bonds, const Vec3& q) {
  Mat3 sum = Mat3::Zero();
  for (const Bond& bond : bonds) sum += 2 * (1 - std::cos(q.dot(bond.d))) * bond.constants;
  return Eigen::SelfAdjointEigenSolver<Mat3>(sum, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace

std::vector<Vec3> fcc_neighbours(double pitch, double cutoff) {
  const double half_edge = pitch / std::numbers::sqrt2;  // of the cubic cell
  const int n = static_cast<int>(std::ceil(cutoff / half_edge));
  std::vector<Vec3> neighbours;
  for (int z = -n; z <= n; ++z) {
    for (int y = -n; y <= n; ++y) {
      for (int x = -n; x <= n; ++x) {
        if ((x + y + z) % 2 != 0 || (x == 0 && y == 0 && z == 0)) continue;
        const Vec3 d = half_edge * Vec3(x, y, z);
        if (d.norm() < cutoff) neighbours.push_back(d);
      }
    }
  }
  return neighbours;
}

double fcc_volume(double pitch) { return pitch * pitch * pitch / std::numbers::sqrt2; }

double fcc_energy(const PairLaw& law, double pitch) {
  double sum = 0;
  for (const Vec3& d : fcc_neighbours(pitch, law.cutoff())) sum += law.energy(d.norm());
  return sum / 2;
}

double fcc_pressure(const PairLaw& law, double pitch) {
  double virial = 0;
  for (const Vec3& d : fcc_neighbours(pitch, law.cutoff())) virial += law.force(d.norm()) * d.norm();
  return virial / (6 * fcc_volume(pitch));
}

Vec3 squared_frequencies(const PairLaw& law, double mass, double pitch, const Vec3& q) {
  return eigenvalues(half_bonds(law, pitch), q) / mass;
}

double largest_frequency(const PairLaw& law, double mass, double pitch) {
  const std::vector<Bond> bonds = half_bonds(law, pitch);
  // Columns: the reciprocal vectors, b_i . a_j = 2 pi for the primitive cell of edges (0,1,1), (1,0,1),
  // (1,1,0) half cubic edges. A grid of a 24th holds Gamma, X (1/2), L (1/2), W (1/4), K (3/8) and U (5/8).
  constexpr int kGrid = 24;
  Mat3 reciprocal;
  reciprocal << -1, 1, 1, 1, -1, 1, 1, 1, -1;
  reciprocal *= std::numbers::pi * std::numbers::sqrt2 / pitch;
  struct Candidate {
    double value;
    Vec3 at;
  };
  std::vector<Candidate> best;  // of the grid, descending
  constexpr size_t kKept = 8;
  for (int k = 0; k <= kGrid / 2; ++k) {  // q and -q are equal
    for (int j = 0; j < kGrid; ++j) {
      for (int i = 0; i < kGrid; ++i) {
        const Vec3 at = Vec3(i, j, k) / kGrid;
        const double value = eigenvalues(bonds, reciprocal * at)[2];
        if (best.size() == kKept && value <= best.back().value) continue;
        if (best.size() == kKept) best.pop_back();
        const auto place = std::find_if(best.begin(), best.end(), [&](auto& c) { return c.value < value; });
        best.insert(place, {value, at});
      }
    }
  }
  // Compass search: the largest eigenvalue is continuous, but kinks where branches cross.
  double largest = 0;
  for (Candidate c : best) {
    for (double step = 0.5 / kGrid; step > 1e-7; step /= 2) {
      for (bool moved = true; moved;) {
        moved = false;
        for (int axis = 0; axis < 3; ++axis) {
          for (const double sign : {-1.0, 1.0}) {
            Vec3 at = c.at;
            at[axis] += sign * step;
            const double value = eigenvalues(bonds, reciprocal * at)[2];
            // Above rounding, or the search could wander on a flat top.
            if (value > c.value * (1 + 1e-14)) {
              c = {value, at};
              moved = true;
            }
          }
        }
      }
    }
    largest = std::max(largest, c.value);
  }
  return std::sqrt(largest / mass);
}

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

double relaxed_pitch(const PairLaw& law, double guess) {
  if (!(guess > 0)) throw InputError(fmt::format("relaxed_pitch: the guess {:g} m is not above 0", guess));
  const auto pressure = [&](double pitch) { return fcc_pressure(law, pitch); };
  // The root of the crossing between a < b, or nothing where it is a jump.
  const auto root = [&](double a, double b) -> std::optional<double> {
    const double before = std::max(std::abs(pressure(a)), std::abs(pressure(b)));
    for (double middle = a + (b - a) / 2; middle > a && middle < b; middle = a + (b - a) / 2) {
      (pressure(middle) > 0 ? a : b) = middle;
    }
    const bool jump = std::min(std::abs(pressure(a)), std::abs(pressure(b))) > 1e-6 * before;
    return jump ? std::nullopt : std::optional(std::abs(pressure(a)) < std::abs(pressure(b)) ? a : b);
  };
  constexpr double kStep = 1.002;  // per stride of the search
  const double here = pressure(guess);
  if (here == 0 && pressure(guess / kStep) > 0 && pressure(guess * kStep) < 0) return guess;
  double low = guess, high = guess;
  double at_low = here, at_high = here;
  while (high < 2 * guess) {
    const double lower = low / kStep, higher = high * kStep;
    const double at_lower = pressure(lower), at_higher = pressure(higher);
    if (at_high >= 0 && at_higher < 0) {
      if (const auto found = root(high, higher)) return *found;
    }
    if (at_lower > 0 && at_low <= 0) {
      if (const auto found = root(lower, low)) return *found;
    }
    low = lower, high = higher, at_low = at_lower, at_high = at_higher;
  }
  throw InputError(fmt::format("the packing has no pitch of zero pressure between {:g} m and {:g} m",
                               guess / 2, 2 * guess));
}

}  // namespace cuboct
