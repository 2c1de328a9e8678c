// SPDX-License-Identifier: MIT
#include "model/atoms/bond_order/atom_cell.h"

#include "model/base/mat3.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <stdexcept>

namespace cuboct {
namespace {

constexpr double kStrain = 1e-5;
constexpr int kVoigt[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};

// Forces at the cell's atoms in one vector.
Eigen::VectorXd forces_on(TersoffForces& forces, BondList& list, const AtomCell& cell, bool sums) {
  std::vector<Vec3> f(cell.x.size());
  list.update(cell.box, cell.x);
  forces.evaluate(list, cell.box, cell.x, f, {.sums = sums});
  return Eigen::Map<const Eigen::VectorXd>(f[0].data(), static_cast<Eigen::Index>(3 * f.size()));
}

BondList list_for(const TersoffForces& forces) {
  const double cutoff = forces.tersoff().cutoff();
  return {cutoff, 0.05 * cutoff, bond_lanes()};
}

// dF/dx by central differences, less its null space of translations in the solver.
Eigen::MatrixXd hessian_of(TersoffForces& forces, BondList& list, AtomCell cell) {
  const auto n = static_cast<Eigen::Index>(3 * cell.x.size());
  const double step = 1e-5 * forces.tersoff().cutoff();
  Eigen::MatrixXd hessian(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    double& at = cell.x[static_cast<size_t>(k / 3)][k % 3];
    const double here = at;
    at = here + step;
    const Eigen::VectorXd ahead = forces_on(forces, list, cell, false);
    at = here - step;
    hessian.col(k) = (forces_on(forces, list, cell, false) - ahead) / (2 * step);
    at = here;
  }
  return (hessian + hessian.transpose()) / 2;
}

Mat3 strain_of(int voigt, double size) {
  Mat3 strain = Mat3::Zero();
  const auto [a, b] = kVoigt[voigt];
  strain(a, b) += size / 2, strain(b, a) += size / 2;
  return strain;
}

bool repeats(const AtomCell& cell, int voigt) {
  return cell.box.periodic[kVoigt[voigt][0]] && cell.box.periodic[kVoigt[voigt][1]];
}

// Mean of the stresses along axes that repeat, at a cell scaled by `by`.
double pull_at(TersoffForces& forces, const AtomCell& cell, double by) {
  Mat3 strain = Mat3::Zero();
  for (int a = 0; a < 3; ++a)
    if (cell.box.periodic[a]) strain(a, a) = by - 1;
  const Mat3 stress = stress_of(forces, strained(cell, strain));
  double sum = 0;
  for (int a = 0; a < 3; ++a)
    if (cell.box.periodic[a]) sum += stress(a, a);
  return sum;
}

}  // namespace

AtomCell diamond_cell(double a) {
  AtomCell cell;
  cell.box.edges << 0, 1, 1, 1, 0, 1, 1, 1, 0;
  cell.box.edges *= a / 2;
  cell.box.periodic = {true, true, true};
  cell.x = {Vec3::Zero(), Vec3::Constant(a / 4)};
  return cell;
}

AtomCell diamond_block(double a, int nx, int ny, int nz) {
  AtomCell cell;
  cell.box.edges = a * diagonal(Vec3(nx, ny, nz));
  cell.box.periodic = {true, true, true};
  const Vec3 corners[4] = {{0, 0, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}};
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k)
        for (const Vec3& corner : corners)
          for (const double quarter : {0.0, 0.25})
            cell.x.push_back(a * (Vec3(i, j, k) + corner + Vec3::Constant(quarter)));
  return cell;
}

AtomCell graphene_sheet(double bond, double thickness, int nx, int ny) {
  AtomCell cell;
  const Vec3 edge(std::sqrt(3) * bond, 3 * bond, thickness);
  cell.box.edges = diagonal({nx * edge[0], ny * edge[1], thickness});
  cell.box.periodic = {true, true, false};
  const Vec3 basis[4] = {{0, 0, 0}, {0.5, 1.0 / 6, 0}, {0.5, 0.5, 0}, {0, 2.0 / 3, 0}};
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      for (const Vec3& at : basis) cell.x.push_back((Vec3(i, j, 0) + at).cwiseProduct(edge));
  return cell;
}

AtomCell strained(const AtomCell& cell, const Mat3& strain) {
  AtomCell other = cell;
  const Mat3 deformation = Mat3::Identity() + strain;
  other.box.edges = deformation * cell.box.edges;
  for (Vec3& x : other.x) x = deformation * x;
  return other;
}

void rest_within(TersoffForces& forces, AtomCell& cell, double force) {
  BondList list = list_for(forces);
  constexpr int kMost = 30;
  for (int k = 0; k < kMost; ++k) {
    const Eigen::VectorXd f = forces_on(forces, list, cell, false);
    if (f.cwiseAbs().maxCoeff() <= force) return;
    // The least-squares solution leaves translations alone.
    const Eigen::MatrixXd hessian = hessian_of(forces, list, cell);
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-7);
    const Eigen::VectorXd step = solver.compute(hessian).solve(f);
    for (size_t i = 0; i < cell.x.size(); ++i) cell.x[i] += step.segment<3>(static_cast<Eigen::Index>(3 * i));
  }
  throw std::runtime_error(
      fmt::format("a cell of {} atoms has not come to rest in {} steps", cell.x.size(), kMost));
}

double largest_curvature(TersoffForces& forces, const AtomCell& cell) {
  constexpr int kTurns = 500;
  BondList list = list_for(forces);
  const Eigen::MatrixXd hessian = hessian_of(forces, list, cell);
  // Neighbours move against each other: numbers without a pattern.
  Eigen::VectorXd direction(hessian.rows());
  for (Eigen::Index k = 0; k < direction.size(); ++k)
    direction[k] = std::sin(12.9898 * static_cast<double>(k) + 1);
  double largest = 0;
  for (int turn = 0; turn < kTurns && direction.norm() > 0; ++turn) {
    direction.normalize();
    const Eigen::VectorXd bent = hessian * direction;
    largest = direction.dot(bent);
    direction = bent;
  }
  return largest;
}

Mat3 stress_of(TersoffForces& forces, const AtomCell& cell) {
  BondList list = list_for(forces);
  forces_on(forces, list, cell, true);
  return forces.virial() / cell.box.volume();
}

AtomCell at_no_pressure(TersoffForces& forces, const AtomCell& cell) {
  double low = 1, high = 1;
  while (pull_at(forces, cell, low) > 0 && low > 0.8) low -= 0.01;
  while (pull_at(forces, cell, high) < 0 && high < 1.2) high += 0.01;
  if (pull_at(forces, cell, low) > 0 || pull_at(forces, cell, high) < 0)
    throw std::runtime_error("the cell has no size without pressure within 20 % of the given one");
  for (int k = 0; k < 60 && high - low > 1e-15; ++k) {
    const double middle = (low + high) / 2;
    (pull_at(forces, cell, middle) < 0 ? low : high) = middle;
  }
  Mat3 strain = Mat3::Zero();
  for (int a = 0; a < 3; ++a)
    if (cell.box.periodic[a]) strain(a, a) = (low + high) / 2 - 1;
  return strained(cell, strain);
}

CellConstants constants_of(TersoffForces& forces, const AtomCell& cell) {
  CellConstants constants;
  constants.stress = stress_of(forces, cell);
  constants.energy = forces.energy() / static_cast<double>(cell.x.size());
  // A force that leaves its mark on a constant of some A/R^3 far behind the differences' error.
  const double force = 1e-12 * forces.tersoff().terms[0].A / forces.tersoff().cutoff();
  for (int k = 0; k < 6; ++k) {
    if (!repeats(cell, k)) continue;
    Mat3 clamped[2], relaxed[2];
    for (int side = 0; side < 2; ++side) {
      AtomCell moved = strained(cell, strain_of(k, side == 0 ? kStrain : -kStrain));
      clamped[side] = stress_of(forces, moved);
      rest_within(forces, moved, force);
      relaxed[side] = stress_of(forces, moved);
    }
    for (int of = 0; of < 6; ++of) {
      if (!repeats(cell, of)) continue;
      const auto [a, b] = kVoigt[of];
      constants.clamped(of, k) = (clamped[0](a, b) - clamped[1](a, b)) / (2 * kStrain);
      constants.relaxed(of, k) = (relaxed[0](a, b) - relaxed[1](a, b)) / (2 * kStrain);
    }
  }
  return constants;
}

}  // namespace cuboct
