// SPDX-License-Identifier: MIT
#include "model/solid/vibrations.h"

#include <Spectra/SymEigsSolver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "model/base/dense.h"
#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

using Matrix = Vibrations::Matrix;

// The symmetric matrix a K + b C + shift as an operator.
class Combined {
 public:
  using Scalar = double;
  Combined(const Matrix& k, const Matrix& c, double a, double b, double shift = 0)
      : k_(k), c_(c), a_(a), b_(b), shift_(shift) {}
  Eigen::Index rows() const { return k_.rows(); }
  Eigen::Index cols() const { return k_.cols(); }
  void perform_op(const double* in, double* out) const {
    const Eigen::Map<const Eigen::VectorXd> x(in, rows());
    Eigen::Map<Eigen::VectorXd> y(out, rows());
    y.noalias() = a_ * (k_ * x);
    if (b_ != 0) y.noalias() += b_ * (c_ * x);
    if (shift_ != 0) y += shift_ * x;
  }
  Eigen::MatrixXd dense() const {
    Eigen::MatrixXd m = a_ * Eigen::MatrixXd(k_);
    if (b_ != 0) m += b_ * Eigen::MatrixXd(c_);
    m.diagonal().array() += shift_;
    return m;
  }

 private:
  const Matrix& k_;
  const Matrix& c_;
  double a_, b_, shift_;
};

struct Mode {
  double value = 0;
  Eigen::VectorXd y;  // of length 1
};

constexpr Eigen::Index kDenseRows = 64;  // rows up to which a full decomposition is as quick

// The largest eigenvalue; `start` is where the iterations begin.
Mode largest(const Combined& m, const Eigen::VectorXd& start, double tolerance) {
  if (m.rows() <= kDenseRows) {
    const auto [values, vectors] = eigensystem(m.dense());
    const Eigen::Index last = m.rows() - 1;
    return {values[last], vectors.col(last)};
  }
  constexpr Eigen::Index kKept = 40;  // Lanczos vectors
  Spectra::SymEigsSolver<Combined> solver(const_cast<Combined&>(m), 1, kKept);
  solver.init(start.data());
  solver.compute(Spectra::SortRule::LargestAlge, 2000, tolerance);
  if (solver.info() != Spectra::CompInfo::Successful)
    throw std::runtime_error("the Lanczos iterations for the largest frequency did not converge");
  return {solver.eigenvalues()[0], solver.eigenvectors().col(0)};
}

// A start without the symmetries of a crystal, the same everywhere.
Eigen::VectorXd start_vector(Eigen::Index rows) {
  Eigen::VectorXd y(rows);
  uint64_t state = 1;
  for (Eigen::Index i = 0; i < rows; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    y[i] = static_cast<double>(state >> 11) * 0x1p-52 - 1;
  }
  return y;
}

}  // namespace

Vibrations vibrations_of(const Rule& rule, const Body& body, const Periodic& periodic) {
  Vibrations out;
  std::vector<std::array<int, 3>> row(body.size());
  bool damps = rule.damping.coefficient > 0;
  for (uint32_t i = 0; i < body.size(); ++i) {
    const ParticleType& type = rule.types[body.type[i]];
    damps = damps || (type.pd && type.kd > 0);
    for (int axis = 0; axis < 3; ++axis) {
      row[i][axis] = type.imposed[axis] ? -1 : static_cast<int>(out.particle.size());
      if (type.imposed[axis]) continue;
      out.particle.push_back(i);
      out.axis.push_back(axis);
    }
  }
  using Entry = Eigen::Triplet<double, int>;
  std::vector<Entry> stiffness, damping;
  const auto add = [&](std::vector<Entry>& entries, uint32_t i, uint32_t j, const Mat3& block) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        if (row[i][a] >= 0 && row[j][b] >= 0) entries.emplace_back(row[i][a], row[j][b], block(a, b));
  };
  std::vector<double> relative;  // masses
  for (const uint8_t type : body.type) relative.push_back(rule.relative_mass(type));
  // The diagonal blocks are summed first: one entry each.
  std::vector<Mat3> own(body.size(), Mat3::Zero()), own_damping(damps ? body.size() : 0, Mat3::Zero());
  CellList cells(rule.cutoff(), periodic);
  cells.build(body.x);
  cells.for_each_pair(body.x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    if (r >= rule.reach(body.type[i], body.type[j])) return;
    const Vec3 e = d / r;
    const double scale = rule.strength_of(body.type[i], body.type[j]) / rule.mass;
    const PairLaw& law = rule.law_of(body.type[i], body.type[j]);
    const double axial = -law.slope(r), lateral = -law.force(r) / r;
    const Mat3 along = e * e.transpose();
    const Mat3 block = scale * (lateral * Mat3::Identity() + (axial - lateral) * along);
    const double r_i = relative[i], r_j = relative[j], both = std::sqrt(r_i * r_j);
    own[i] += block / r_i, own[j] += block / r_j;
    add(stiffness, i, j, -block / both), add(stiffness, j, i, -block / both);
    if (rule.damping.coefficient > 0) {
      const Mat3 drag = scale * rule.damping_over_r2(r) * r * r * along;
      own_damping[i] += drag / r_i, own_damping[j] += drag / r_j;
      add(damping, i, j, -drag / both), add(damping, j, i, -drag / both);
    }
  });
  for (uint32_t i = 0; i < body.size(); ++i) {
    const ParticleType& type = rule.types[body.type[i]];
    if (type.pd) {
      const double mass = rule.mass_of(body.type[i]);
      own[i] += type.kp / mass * Mat3::Identity();
      if (damps) own_damping[i] += type.kd / mass * Mat3::Identity();
    }
    add(stiffness, i, i, own[i]);
    if (damps) add(damping, i, i, own_damping[i]);
  }
  const auto n = static_cast<Eigen::Index>(out.particle.size());
  out.stiffness.resize(n, n);
  out.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());
  stiffness = {};
  if (damps) {
    out.damping.resize(n, n);
    out.damping.setFromTriplets(damping.begin(), damping.end());
  }
  return out;
}

Limit stability_limit(const Vibrations& vibrations) {
  const Matrix &k = vibrations.stiffness, &c = vibrations.damping;
  Limit limit;
  limit.dt = std::numeric_limits<double>::infinity();
  if (k.rows() == 0 || (k.norm() == 0 && (c.rows() == 0 || c.norm() == 0))) return limit;

  // An eigenvalue is at most this (a fraction of itself) from the one that is found; dt errs by half of it.
  constexpr double kTolerance = 1e-5;
  const Mode stiffest = largest({k, c, 1, 0}, start_vector(k.rows()), kTolerance);
  limit.frequency = std::sqrt(std::max(0.0, stiffest.value));
  // Turned over, so that a mode at 0 is no small number to be found to its last digits. What is missed below
  // 0 grows by less than exp(sqrt(1e-4) w dt) per step.
  limit.softest = stiffest.value - largest({k, c, -1, 0, stiffest.value}, start_vector(k.rows()), 1e-4).value;
  Mode mode = stiffest;
  double share = 0;
  // The limit of a mode of stiffness w2 and damping g, both per unit mass.
  const auto limit_of = [](double w2, double g) {
    return 4 / (std::sqrt(std::max(0.0, g * g + 4 * w2)) + g);
  };
  if (c.rows() == 0 || c.norm() == 0) {
    limit.dt = limit.frequency > 0 ? 2 / limit.frequency : limit.dt;
  } else {
    double dt = limit_of(stiffest.y.dot(k * stiffest.y), stiffest.y.dot(c * stiffest.y));
    if (!std::isfinite(dt)) dt = 4 / c.norm();
    for (int round = 0; round < 50; ++round) {
      mode = largest({k, c, dt * dt, 2 * dt}, mode.y + 1e-3 * start_vector(k.rows()) / std::sqrt(k.rows()),
                     kTolerance);
      const double g = mode.y.dot(c * mode.y);
      const double next = limit_of(mode.y.dot(k * mode.y), g);
      share = next * g / 2;
      const double change = std::abs(next / dt - 1);
      dt = next;
      if (change < kTolerance) break;
    }
    limit.dt = dt;
  }
  limit.damping_share = share;
  std::vector<double> size(vibrations.particle.back() + 1, 0.0);
  for (Eigen::Index i = 0; i < k.rows(); ++i) size[vibrations.particle[i]] += mode.y[i] * mode.y[i];
  limit.particle = static_cast<uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
  return limit;
}

}  // namespace cuboct
