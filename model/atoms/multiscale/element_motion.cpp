// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/element_motion.h"

#include <Eigen/Dense>
#include <utility>

#include "model/atoms/multiscale/element_stiffness.h"
#include "model/base/mat3.h"

namespace cuboct {
namespace {

// Of the mean stiffness: lets the matrix be factorised, whose motions as a whole nothing restores.
constexpr double kHold = 1e-9;

// Translations, and rotations about axes across which no other axis repeats.
Eigen::MatrixXd rigid_motions(const ElementBody& body) {
  const std::vector<Vec3>& x = body.mesh().x;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& one : x) middle += one / static_cast<double>(x.size());
  std::vector<Eigen::VectorXd> out;
  const auto add = [&](const auto& motion) {
    Eigen::VectorXd v(static_cast<Eigen::Index>(3 * x.size()));
    for (size_t i = 0; i < x.size(); ++i)
      v.segment<3>(static_cast<Eigen::Index>(3 * i)) = eigen(motion(x[i]));
    for (const Eigen::VectorXd& other : out) v -= other.dot(v) * other;
    out.push_back(v.normalized());
  };
  for (int a = 0; a < 3; ++a) add([&](const Vec3&) -> Vec3 { return Vec3::Unit(a); });
  for (int a = 0; a < 3; ++a)
    if (body.mesh().period[(a + 1) % 3] == 0 && body.mesh().period[(a + 2) % 3] == 0)
      add([&](const Vec3& at) -> Vec3 { return Vec3::Unit(a).cross(at - middle); });
  Eigen::MatrixXd columns(out[0].size(), static_cast<Eigen::Index>(out.size()));
  for (size_t k = 0; k < out.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = out[k];
  return columns;
}

}  // namespace

ElementMotion::ElementMotion(ElementBody& body, double dt, VertexLoad load)
    : body_(body), dt_(dt), load_(std::move(load)), v_(body.x().size(), Vec3::Zero()) {
  forces();
}

void ElementMotion::forces() {
  body_.update();
  force_ = body_.force();
  if (load_) load_(time(), force_);
}

void ElementMotion::step() {
  const std::vector<double>& mass = body_.mass();
  for (size_t i = 0; i < v_.size(); ++i) {
    v_[i] += dt_ / (2 * mass[i]) * force_[i];
    body_.x()[i] += dt_ * v_[i];
  }
  ++steps_;
  forces();
  for (size_t i = 0; i < v_.size(); ++i) v_[i] += dt_ / (2 * mass[i]) * force_[i];
}

double ElementMotion::kinetic_energy() const {
  double sum = 0;
  for (size_t i = 0; i < v_.size(); ++i) sum += body_.mass()[i] * v_[i].squaredNorm() / 2;
  return sum;
}

Vec3 ElementMotion::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (size_t i = 0; i < v_.size(); ++i) sum += body_.mass()[i] * v_[i];
  return sum;
}

void ElementMotion::restore(uint64_t steps) {
  steps_ = steps;
  forces();
}

ElementRest::ElementRest(const ElementBody& body) {
  Eigen::SparseMatrix<double> stiffness = element_stiffness(body);
  const double hold = kHold * stiffness.diagonal().mean();
  for (Eigen::Index i = 0; i < stiffness.rows(); ++i) stiffness.coeffRef(i, i) += hold;
  factors_.compute(stiffness);
  rigid_ = rigid_motions(body);
}

// The moment of the forces is 0 about where the vertices are now, not about where they were: what is left of
// it there is no force, and over kHold would be a large motion.
void ElementRest::take_out_rigid(Eigen::VectorXd& v) const { v -= rigid_ * (rigid_.transpose() * v); }

RestResult ElementRest::operator()(ElementBody& body, double force, int most) const {
  RestResult out;
  Eigen::VectorXd f(static_cast<Eigen::Index>(3 * body.x().size()));
  while (true) {
    body.update();
    ++out.iterations;
    for (size_t v = 0; v < body.x().size(); ++v)
      f.segment<3>(static_cast<Eigen::Index>(3 * v)) = eigen(body.force()[v]);
    out.force = f.cwiseAbs().maxCoeff();
    out.at_rest = out.force <= force;
    if (out.at_rest || out.iterations >= most) return out;
    take_out_rigid(f);
    Eigen::VectorXd move = factors_.solve(f);
    take_out_rigid(move);
    for (size_t v = 0; v < body.x().size(); ++v)
      body.x()[v] += move.segment<3>(static_cast<Eigen::Index>(3 * v));
  }
}

}  // namespace cuboct
