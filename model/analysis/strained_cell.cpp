// SPDX-License-Identifier: MIT
#include "model/analysis/strained_cell.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <stdexcept>

#include "model/base/interrupt.h"

namespace cuboct {
namespace {

// Images stand within this part of the cutoff beyond it, and are gathered anew once a particle has gone half
// as far.
constexpr double kMargin = 0.1;
// A particle is at rest where its force would move it, against the stiffest site, by this part of the cutoff.
constexpr double kAtRest = 1e-12;
constexpr double kLongestStep = 0.02;  // of the cutoff

}  // namespace

StrainedCell::StrainedCell(const Rule& rule, CrystalCell cell, int threads)
    : rule_(rule), cell_(std::move(cell)), threads_(threads) {
  rule_.damping.coefficient = 0;
  for (ParticleType& type : rule_.types) type.pd = false;  // of the pairs alone
  gather();
  stiffness_ = largest_site_stiffness(rule_, body_, {});
}

void StrainedCell::gather() {
  images_ = images_of(cell_, (1 + kMargin) * rule_.cutoff());
  body_.type = cell_.type;
  for (const CellImage& image : images_) body_.type.push_back(cell_.type[image.owner]);
  body_.x.resize(body_.type.size());
  body_.v.assign(body_.type.size(), Vec3::Zero());
  gathered_.clear();
  reference_.reset();
  place();
}

void StrainedCell::place() {
  const size_t own = cell_.x.size();
  for (size_t i = 0; i < own; ++i) body_.x[i] = cell_.x[i];
  for (size_t i = 0; i < images_.size(); ++i)
    body_.x[own + i] = cell_.x[images_[i].owner] + cell_.vectors * images_[i].shift;
  if (gathered_.empty()) {
    gathered_ = body_.x;
    reference_.emplace(rule_, body_, Periodic{}, RealOptions{.threads = threads_});
    return;
  }
  // Half the margin for each end of a pair.
  const double most = kMargin / 2 * rule_.cutoff();
  for (size_t i = 0; i < body_.size(); ++i)
    if ((body_.x[i] - gathered_[i]).squaredNorm() > most * most) return gather();
  reference_->place(body_);
}

void StrainedCell::deform(const Mat3& deformation) {
  cell_ = cell_.deformed(deformation);
  place();
}

uint64_t StrainedCell::relax(uint64_t most) {
  const auto own = static_cast<Eigen::Index>(3 * cell_.x.size());
  using Flat = Eigen::Map<Eigen::VectorXd>;
  Eigen::VectorXd x = Flat(cell_.x[0].data(), own);
  const double small = kAtRest * stiffness_ * rule_.cutoff();
  double left = 0;
  const FireResult result = fire(x,
                                 [&](const Eigen::VectorXd& at, Eigen::VectorXd& f) {
                                   if (interrupted()) throw std::runtime_error("interrupted");
                                   Flat(cell_.x[0].data(), own) = at;
                                   place();
                                   std::vector<Vec3> forces = reference_->forces();
                                   f = Flat(forces[0].data(), own);
                                   left = f.cwiseAbs().maxCoeff();
                                   return left <= small;
                                 },
                                 {.stiffness = std::max(stiffness_, 1e-300),
                                  .longest_step = kLongestStep * rule_.cutoff(),
                                  .most = most});
  if (!result.at_rest)
    throw std::runtime_error(fmt::format(
        "the cell does not come to rest: a force of {:.3g} N is left after {} evaluations", left, most));
  return result.evaluations;
}

Mat3 StrainedCell::stress() const {
  const std::vector<Mat3> all = reference_->virial_stress(cell_.volume());
  Mat3 sum = Mat3::Zero();
  for (size_t i = 0; i < cell_.x.size(); ++i) sum += all[i];
  return sum;
}

Matrix6 constants_by_strain(const Rule& rule, const CrystalCell& cell, double strain, int threads,
                            uint64_t& evaluations) {
  Matrix6 out = Matrix6::Zero();
  for (int v = 0; v < 6; ++v) {
    const auto [a, b] = kVoigt[v];
    if (!cell.repeats[a] || !cell.repeats[b]) continue;
    Mat3 e = Mat3::Zero();
    e(a, b) += strain / 2, e(b, a) += strain / 2;
    Mat3 slope = Mat3::Zero();
    for (const double sign : {-1.0, 1.0}) {
      StrainedCell strained(rule, cell, threads);
      strained.deform(Mat3::Identity() + sign * e);
      evaluations += strained.relax();
      slope += sign * strained.stress() / (2 * strain);
    }
    for (int w = 0; w < 6; ++w)
      if (cell.repeats[kVoigt[w][0]] && cell.repeats[kVoigt[w][1]])
        out(w, v) = slope(kVoigt[w][0], kVoigt[w][1]);
  }
  return out;
}

CrystalCell without_stress(const Rule& rule, const CrystalCell& cell, int threads) {
  constexpr int kMostRounds = 50;
  constexpr double kSmall = 1e-10;   // of the largest constant
  constexpr double kLargest = 0.02;  // strain of a round
  StrainedCell strained(rule, cell, threads);
  for (int round = 0; round < kMostRounds; ++round) {
    strained.relax();
    const ElasticTensor tensor = elastic_tensor(rule, strained.cell());
    Eigen::Matrix<double, 6, 1> stress;
    Matrix6 c = tensor.c;
    for (int v = 0; v < 6; ++v) {
      const auto [a, b] = kVoigt[v];
      const bool repeats = cell.repeats[a] && cell.repeats[b];
      stress[v] = repeats ? tensor.stress(a, b) : 0;
      if (!repeats) c(v, v) = 1;
    }
    if (stress.cwiseAbs().maxCoeff() <= kSmall * tensor.c.cwiseAbs().maxCoeff()) return strained.cell();
    Eigen::Matrix<double, 6, 1> e = -c.partialPivLu().solve(stress);
    if (const double most = e.cwiseAbs().maxCoeff(); most > kLargest) e *= kLargest / most;
    Mat3 deformation = Mat3::Identity();
    for (int v = 0; v < 6; ++v) {
      const auto [a, b] = kVoigt[v];
      deformation(a, b) += e[v] / (a == b ? 1 : 2);
      if (a != b) deformation(b, a) += e[v] / 2;
    }
    strained.deform(deformation);
  }
  throw std::runtime_error("the cell finds no size at which it carries no stress");
}

}  // namespace cuboct
