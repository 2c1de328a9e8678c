// SPDX-License-Identifier: MIT
#include "model/solid/elastic_tensor.h"

#include <fmt/format.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <cmath>
#include <stdexcept>

#include "model/base/dense.h"

namespace cuboct {
namespace {

using Couplings = Eigen::Matrix<double, Eigen::Dynamic, 6>;
constexpr Eigen::Index kDenseFreedoms = 450;  // degrees of freedom

[[noreturn]] void no_minimum(const std::string& why) {
  throw std::runtime_error("the cell is at no minimum of its energy: " + why);
}

// The displacements against the couplings, K^-1 L, by the eigenvectors of K: those at 0 have no coupling.
Couplings solve_dense(const Eigen::MatrixXd& k, const Couplings& couplings) {
  const auto [values, vectors] = eigensystem(k);
  const double zero = 1e-9 * values[values.size() - 1];
  if (values[0] < -zero) no_minimum(fmt::format("a stiffness of {:.4g} N/m", values[0]));
  Eigen::VectorXd inverse = values;
  for (double& value : inverse) value = value > zero ? 1 / value : 0;
  return vectors * inverse.asDiagonal() * (vectors.transpose() * couplings);
}

Couplings solve_sparse(const Eigen::SparseMatrix<double>& k, const Couplings& couplings) {
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver(k);
  solver.setTolerance(1e-11);
  solver.setMaxIterations(20 * k.rows());
  Couplings out(couplings.rows(), 6);
  for (int v = 0; v < 6; ++v) {
    out.col(v) = solver.solve(couplings.col(v));
    if (solver.info() != Eigen::Success || out.col(v).dot(couplings.col(v)) < 0)
      no_minimum("its stiffness has no inverse");
  }
  return out;
}

Eigen::SparseMatrix<double> force_constants(const std::vector<CellBond>& bonds, size_t particles) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const CellBond& bond : bonds) {
    if (bond.from == bond.to) continue;
    const auto& [axial, lateral] = bond.constants;
    const Vec3 e = bond.d.normalized();
    const Mat3 block = lateral * Mat3::Identity() + (axial - lateral) * e * e.transpose();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const int row = static_cast<int>(3 * bond.from) + a;
        entries.emplace_back(row, static_cast<int>(3 * bond.from) + b, block(a, b));
        entries.emplace_back(row, static_cast<int>(3 * bond.to) + b, -block(a, b));
      }
  }
  const auto n = static_cast<Eigen::Index>(3 * particles);
  Eigen::SparseMatrix<double> k(n, n);
  k.setFromTriplets(entries.begin(), entries.end());
  return k;
}

}  // namespace

Matrix6 stress_strain(const Matrix6& lagrangian, const Mat3& t) {
  const auto e = [](int a, int b) { return a == b ? 1.0 : 0.0; };
  Matrix6 out = lagrangian;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const auto [a, b] = kVoigt[i];
      const auto [c, d] = kVoigt[j];
      out(i, j) += (t(a, d) * e(b, c) + t(b, d) * e(a, c) + t(a, c) * e(b, d) + t(b, c) * e(a, d) -
                    2 * t(a, b) * e(c, d)) /
                   2;
    }
  return out;
}

ElasticTensor elastic_tensor(const Rule& rule, const CrystalCell& cell) {
  const std::vector<CellBond> bonds = bonds_of(rule, cell);
  const double volume = cell.volume();
  ElasticTensor out;
  Couplings couplings = Couplings::Zero(static_cast<Eigen::Index>(3 * cell.x.size()), 6);
  std::vector<Vec3> force(cell.x.size(), Vec3::Zero());
  double coupled = 0;  // what the couplings would sum up to without their signs
  for (const CellBond& bond : bonds) {
    const auto& [axial, lateral] = bond.constants;
    const double g = (axial - lateral) / bond.d.squaredNorm();
    Eigen::Matrix<double, 6, 1> dd;
    for (int v = 0; v < 6; ++v) dd[v] = bond.d[kVoigt[v][0]] * bond.d[kVoigt[v][1]];
    out.born += g / (2 * volume) * dd * dd.transpose();
    out.stress += lateral / (2 * volume) * bond.d * bond.d.transpose();
    couplings.middleRows<3>(3 * bond.from) += g * eigen(bond.d) * dd.transpose();
    force[bond.from] += lateral * bond.d;
    coupled = std::max(coupled, std::abs(g) * bond.d.norm() * dd.norm());
  }
  for (const Vec3& f : force) out.residual = std::max(out.residual, f.norm());
  // Of a site that is a centre of symmetry only rounding is left.
  couplings =
      couplings.unaryExpr([&](double value) { return std::abs(value) < 1e-10 * coupled ? 0 : value; });
  Matrix6 c = out.born;
  if (!couplings.isZero(0)) {
    const Eigen::SparseMatrix<double> k = force_constants(bonds, cell.x.size());
    const Couplings moved =
        k.rows() <= kDenseFreedoms ? solve_dense(Eigen::MatrixXd(k), couplings) : solve_sparse(k, couplings);
    c -= couplings.transpose() * moved / volume;
  }
  out.born = stress_strain(out.born, out.stress);
  out.c = stress_strain(c, out.stress);
  for (int v = 0; v < 6; ++v)
    for (const int axis : kVoigt[v])
      if (!cell.repeats[axis]) out.c.row(v).setZero(), out.c.col(v).setZero();
  return out;
}

}  // namespace cuboct
