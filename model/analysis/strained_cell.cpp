// SPDX-License-Identifier: MIT
#include "model/analysis/strained_cell.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <stdexcept>

#include "model/base/interrupt.h"
#include "model/real/rounds_engine.h"
#include "model/scene/rule_cell.h"

namespace cuboct {
namespace {

// Images stand within this part of the cutoff beyond it, and are gathered anew once a particle has gone half
// as far.
constexpr double kMargin = 0.1;
// A particle is at rest where its force would move it, against the stiffest site, by this part of the cutoff.
constexpr double kAtRest = 1e-12;
constexpr double kLongestStep = 0.02;  // of the cutoff
constexpr double kUsualStrain = 1e-6;

}  // namespace

StrainedCell::StrainedCell(const Rule& rule, CrystalCell cell, int threads)
    : rule_(rule), cell_(std::move(cell)), threads_(threads) {
  rule_.damping.coefficient = 0;
  for (ParticleType& type : rule_.types) type.pd = false;  // of the pairs alone
  const RoundsRule* rounds = rule_.rounds.get();
  if (rounds != nullptr) refuse_cell(rule_);
  range_ = (reaches_of(rule_) + kMargin) * rule_.cutoff();
  lasting_ = has_reference_bonds(rule_);
  if (lasting_ && !cell_.packed) cell_.packed = std::make_shared<const CrystalCell>(cell_);
  gather();
  stiffness_ = rounds == nullptr ? largest_site_stiffness(rule_, body_, {}) : rounds->stiffness();
}

void StrainedCell::gather() {
  images_ = images_of(lasting_ ? *cell_.packed : cell_, range_);
  body_.type = cell_.type;
  for (const CellImage& image : images_) body_.type.push_back(cell_.type[image.owner]);
  body_.x.resize(body_.type.size());
  body_.v.assign(body_.type.size(), Vec3::Zero());
  gathered_.clear();
  reference_.reset();
  rounds_.reset();
  place();
}

void StrainedCell::places(const CrystalCell& cell, std::vector<Vec3>& to) const {
  const size_t own = cell.x.size();
  for (size_t i = 0; i < own; ++i) to[i] = cell.x[i];
  for (size_t i = 0; i < images_.size(); ++i)
    to[own + i] = cell.x[images_[i].owner] + cell.vectors * images_[i].shift;
}

void StrainedCell::make_engine() {
  const RealOptions options{.threads = threads_};
  if (rule_.rounds == nullptr) {
    reference_.emplace(rule_, body_, Periodic{}, options);
    return;
  }
  Body packed = body_;
  if (lasting_) places(*cell_.packed, packed.x);
  rounds_ = make_rounds_engine(rule_, with_bonds(rule_, body_, packed), Periodic{}, options);
}

void StrainedCell::place() {
  places(cell_, body_.x);
  if (gathered_.empty()) {
    gathered_ = body_.x;
    return make_engine();
  }
  if (lasting_) return rounds_->place(body_, 0);
  // Half the margin for each end of a pair.
  const double most = kMargin / 2 * rule_.cutoff();
  for (size_t i = 0; i < body_.size(); ++i)
    if ((body_.x[i] - gathered_[i]).squaredNorm() > most * most) return gather();
  rounds_ ? rounds_->place(body_, 0) : reference_->place(body_);
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
                                   std::vector<Vec3> forces =
                                       rounds_ ? rounds_->forces() : reference_->forces();
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
  Mat3 sum = Mat3::Zero();
  if (rounds_) {
    const RoundsTerms& terms = *rounds_->terms();
    for (size_t i = 0; i < cell_.x.size(); ++i) sum += terms.stress(i, cell_.volume());
    return sum;
  }
  const std::vector<Mat3> all = reference_->virial_stress(cell_.volume());
  for (size_t i = 0; i < cell_.x.size(); ++i) sum += all[i];
  return sum;
}

Matrix6 constants_by_strain(const Rule& rule, const CrystalCell& cell, double strain, int threads,
                            uint64_t& evaluations, const Begins& begins) {
  Matrix6 out = Matrix6::Zero();
  for (int v = 0; v < 6; ++v) {
    const auto [a, b] = kVoigt[v];
    if (!cell.repeats[a] || !cell.repeats[b]) continue;
    Mat3 e = Mat3::Zero();
    e(a, b) += strain / 2, e(b, a) += strain / 2;
    Mat3 slope = Mat3::Zero();
    for (const double sign : {-1.0, 1.0}) {
      if (begins) begins(2 * v + (sign < 0 ? 1 : 2));
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

ElasticTensor tensor_of(const Rule& rule, const CrystalCell& cell, double strain, int threads,
                        uint64_t& evaluations, const Begins& begins) {
  if (rule.rounds == nullptr) return elastic_tensor(rule, cell);
  ElasticTensor tensor;
  tensor.stress = StrainedCell(rule, cell, threads).stress();
  tensor.c = constants_by_strain(rule, cell, strain, threads, evaluations, begins);
  return tensor;
}

CrystalCell without_stress(const Rule& rule, const CrystalCell& cell, int threads) {
  constexpr int kMostRounds = 50;
  constexpr double kSmall = 1e-10;   // of the largest constant
  constexpr double kLargest = 0.02;  // strain of a round
  StrainedCell strained(rule, cell, threads);
  for (int round = 0; round < kMostRounds; ++round) {
    strained.relax();
    uint64_t evaluations = 0;
    const ElasticTensor tensor = tensor_of(rule, strained.cell(), kUsualStrain, threads, evaluations);
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
