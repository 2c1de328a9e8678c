// SPDX-License-Identifier: MIT
#include "model/real/balance.h"

#include <algorithm>
#include <utility>

#include "model/contract/bond.h"
#include "model/contract/box_deformation.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

// A step of FIRE is no longer than this part of the cutoff.
constexpr double kLongestStep = 0.02;
// A force of a particle that is rounding: of its stiffness times the cutoff.
constexpr double kRounding = 1e-12;

using Flat = Eigen::Map<Eigen::VectorXd>;
Flat flat(std::vector<Vec3>& values) {
  return {values.empty() ? nullptr : values[0].data(), static_cast<Eigen::Index>(3 * values.size())};
}

Body at_rest(const Rule& rule, Body body) {
  std::fill(body.v.begin(), body.v.end(), Vec3::Zero());
  body.exact.reset();
  const bool pd = std::ranges::any_of(rule.types, &ParticleType::pd);
  if (pd && body.u.empty()) body.u.assign(body.size(), Vec3::Zero());
  return with_bonds(rule, body, body);
}

}  // namespace

Balance::Balance(const Rule& rule, const Body& body, const Periodic& periodic, int threads)
    : rule_(rule),
      body_(at_rest(rule, body)),
      periodic_(periodic),
      threads_(threads),
      stiffness_(rule.rounds != nullptr ? rule.rounds->stiffness()
                                        : largest_site_stiffness(rule, body, periodic)) {
  make_lists();
  for (size_t i = 0; i < body_.u.size(); ++i) anchor_.push_back(body_.x[i] - body_.u[i]);
}

void Balance::make_lists() { reference_.emplace(rule_, body_, periodic_, RealOptions{.threads = threads_}); }

void Balance::recall(Memory memory) {
  stiffness_ = memory.stiffness;
  before_ = std::move(memory.before);
  anchor_ = std::move(memory.anchor);
  box_load_ = memory.box_load;
  forces();
}

void Balance::place(const Eigen::VectorXd& x) {
  flat(body_.x) = x;
  for (size_t i = 0; i < body_.u.size(); ++i) body_.u[i] = body_.x[i] - anchor_[i];
  reference_->place(body_);
}

const std::vector<Vec3>& Balance::forces() {
  carried_ = reference_->forces();
  free_ = carried_;
  for (size_t i = 0; i < free_.size(); ++i) {
    const ParticleType& type = rule_.types[body_.type[i]];
    if (loaded_) free_[i] += rule_.mass_of(body_.type[i]) * type.gravity;
    if (type.pd) free_[i] -= type.kp * body_.u[i];
    for (int axis = 0; axis < 3; ++axis)
      if (type.imposed[axis]) free_[i][axis] = 0;
  }
  return free_;
}

Unbalance Balance::unbalance() const {
  Unbalance out;
  std::vector<Vec3> of_type(rule_.types.size(), Vec3::Zero()), pulled = of_type;
  Vec3 weight = Vec3::Zero();
  for (size_t i = 0; i < free_.size(); ++i) {
    const ParticleType& type = rule_.types[body_.type[i]];
    out.residual += free_[i].norm();
    pulled[body_.type[i]] += rule_.mass_of(body_.type[i]) * type.pull;
    for (int axis = 0; axis < 3; ++axis) {
      if (type.imposed[axis] || type.pd) of_type[body_.type[i]][axis] += carried_[i][axis];
      if (!type.imposed[axis]) weight[axis] += rule_.mass_of(body_.type[i]) * type.gravity[axis];
    }
  }
  out.load = std::max(weight.norm(), box_load_);
  // Forces that pull a body apart are its load though they balance.
  for (const auto* forces : {&of_type, &pulled})
    for (const Vec3& force : *forces) out.load = std::max(out.load, force.norm());
  out.least = kRounding * stiffness_ * rule_.cutoff() * static_cast<double>(body_.size());
  return out;
}

double Balance::largest_force() const {
  double most = 0;
  for (const Vec3& f : free_) most = std::max(most, f.squaredNorm());
  return most;
}

// What particles did in the last step, about the box's own motion.
void Balance::remember_step() {
  if (before_.size() == body_.size()) {
    last_step_ = body_.x;
    for (size_t i = 0; i < body_.size(); ++i) last_step_[i] -= before_[i];
  }
  remembered_ = true;
}

// The force through the face across an axis is the stress along it times the face: the sum of stress times
// volume over the box's length.
void Balance::stretch(const Periodic& box) {
  remember_step();
  const BoxStretch with(periodic_, box);
  with.carry(body_.x);
  for (size_t i = 0; i < anchor_.size(); ++i) anchor_[i] = body_.x[i] - body_.u[i];
  periodic_ = box;
  make_lists();
  Mat3 sum = Mat3::Zero();
  for (const Mat3& of : reference_->virial_stress(1)) sum += of;
  for (int axis = 0; axis < 3; ++axis)
    if (with.ratio[axis] != 1) box_load_ = std::max(box_load_, std::abs(sum(axis, axis)) / box.extent[axis]);
}

void Balance::go_on(double time) {
  if (!remembered_) remember_step();
  remembered_ = false;
  before_ = body_.x;
  std::vector<Vec3> moved = body_.x, ahead = body_.x;
  for (size_t i = 0; i < body_.size(); ++i) {
    const ParticleType& type = rule_.types[body_.type[i]];
    if (!last_step_.empty()) ahead[i] += last_step_[i];
    for (int axis = 0; axis < 3; ++axis)
      if (type.imposed[axis]) moved[i][axis] = ahead[i][axis] = body_.x[i][axis] + type.velocity[axis] * time;
    if (type.pd) anchor_[i] += type.velocity * time;
  }
  place(flat(moved));
  if (last_step_.empty()) return;
  forces();
  const double without = largest_force();
  place(flat(ahead));
  forces();
  if (largest_force() > without) place(flat(moved));
}

FireResult Balance::relax(const std::function<bool(const std::vector<Vec3>&)>& small, uint64_t most) {
  if (!(stiffness_ > 0)) return {small(forces()), 1};
  Eigen::VectorXd x = flat(body_.x);
  const auto to_rest = [&](uint64_t evaluations) {
    return fire(
        x,
        [&](const Eigen::VectorXd& at, Eigen::VectorXd& f) {
          place(at);
          forces();
          f = flat(free_);
          return small(free_);
        },
        {.stiffness = stiffness_, .longest_step = kLongestStep * rule_.cutoff(), .most = evaluations});
  };
  FireResult result = to_rest(most);
  while (has_bond_memory(rule_) && result.at_rest) {
    reference_->give_way();
    ++result.evaluations;
    if (small(forces())) break;
    const FireResult again = to_rest(most - std::min(most, result.evaluations));
    result = {again.at_rest, result.evaluations + again.evaluations};
  }
  if (has_reference_bonds(rule_))
    keep_bonds(body_, *reference_->terms());
  else
    make_lists();
  return result;
}

}  // namespace cuboct
