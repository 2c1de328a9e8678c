// SPDX-License-Identifier: MIT
#include "model/atoms/bond_order/atom_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/base/fire.h"
#include "model/base/parallel.h"

namespace cuboct {
namespace {

constexpr size_t kEach = 20000;  // atoms that are worth a thread

using Flat = Eigen::Map<Eigen::VectorXd>;
Flat flat(std::vector<Vec3>& of) { return {of[0].data(), static_cast<Eigen::Index>(3 * of.size())}; }

void check_sizes(const AtomSystem& system, size_t elements) {
  const size_t n = system.x.size();
  if (n == 0) throw std::invalid_argument("no atom");
  if (!system.v.empty() && system.v.size() != n)
    throw std::invalid_argument(fmt::format("{} positions and {} velocities", n, system.v.size()));
  if (system.mass.size() != elements)
    throw std::invalid_argument(fmt::format("{} masses for {} elements", system.mass.size(), elements));
  for (const double mass : system.mass)
    if (!(mass > 0)) throw std::invalid_argument(fmt::format("a mass of {}", mass));
}

}  // namespace

AtomMotion::AtomMotion(const Tersoff& tersoff, AtomSystem system, const AtomMotionOptions& options)
    : system_(std::move(system)),
      options_(options),
      tersoff_(tersoff),
      list_(tersoff.cutoff(), options.skin > 0 ? options.skin : 0.1 * tersoff.cutoff(), bond_lanes()) {
  check_sizes(system_, tersoff.elements.size());
  if (system_.v.empty()) system_.v.assign(system_.x.size(), Vec3::Zero());
  f_.resize(system_.x.size());
  evaluate(false);
}

void AtomMotion::load(AtomLoads loads) {
  const size_t n = system_.x.size();
  for (const size_t size : {loads.force.size(), loads.imposed.size(), loads.velocity.size()})
    if (size != 0 && size != n) throw std::invalid_argument(fmt::format("{} loads on {} atoms", size, n));
  if (loads.velocity.empty() && !loads.imposed.empty()) loads.velocity.assign(n, Vec3::Zero());
  loads_ = std::move(loads);
}

void AtomMotion::evaluate(bool sums) {
  list_.update(system_.box, system_.x);
  tersoff_.evaluate(list_, system_.box, system_.x, f_,
                    {.sums = sums, .threads = options_.threads, .element = system_.element});
  sums_ = sums;
}

void AtomMotion::kick(double time) {
  const double decay = options_.drag > 0 ? std::exp(-options_.drag * time) : 1;
  for_each_range(
      f_.size(), kEach,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          Vec3 force = f_[i];
          if (!loads_.force.empty()) force += loads_.force[i];
          system_.v[i] = decay * (system_.v[i] + time / mass_of(i) * force);
          if (loads_.imposed.empty()) continue;
          for (int a = 0; a < 3; ++a)
            if (loads_.imposed[i][a]) system_.v[i][a] = loads_.velocity[i][a];
        }
      },
      options_.threads);
}

void AtomMotion::step(uint64_t steps) {
  for (uint64_t k = 0; k < steps; ++k) {
    kick(options_.dt / 2);
    for_each_range(
        f_.size(), kEach,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i) system_.x[i] += options_.dt * system_.v[i];
        },
        options_.threads);
    try {
      evaluate(false);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("step {}: {}; is dt too long?", steps_, error.what()));
    }
    kick(options_.dt / 2);
    ++steps_;
  }
}

// The largest curvature of the energy, by the power method on differences of forces: a dozen turns come
// within some percent of it from below, the margin covers them.
double AtomMotion::stiffest() {
  constexpr int kTurns = 12;
  constexpr double kMargin = 1.3;
  const std::vector<Vec3> home = system_.x, f0 = f_;
  const double step = 1e-4 * tersoff_.tersoff().cutoff();
  std::vector<Vec3> direction(home.size());
  // Neighbours move against each other: numbers without a pattern.
  for (size_t i = 0; i < home.size(); ++i)
    for (int a = 0; a < 3; ++a)
      direction[i][a] = is_free(i, a) ? std::sin(12.9898 * static_cast<double>(3 * i + a) + 1) : 0;
  double largest = 0;
  for (int turn = 0; turn < kTurns; ++turn) {
    flat(direction) *= step / std::max(flat(direction).cwiseAbs().maxCoeff(), 1e-300);
    const double before = flat(direction).norm();
    for (size_t i = 0; i < home.size(); ++i) system_.x[i] = home[i] + direction[i];
    evaluate(false);
    for (size_t i = 0; i < home.size(); ++i)
      for (int a = 0; a < 3; ++a) direction[i][a] = is_free(i, a) ? f0[i][a] - f_[i][a] : 0;
    largest = std::max(largest, flat(direction).norm() / std::max(before, 1e-300));
    if (largest == 0) break;
  }
  system_.x = home;
  f_ = f0;
  return kMargin * largest;
}

AtomMotion::Rest AtomMotion::rest(double force, uint64_t most) {
  evaluate(false);
  Rest rest;
  const double stiffness = stiffest();
  for (Vec3& v : system_.v) v.setZero();
  const auto forces = [&](const Eigen::VectorXd& x, Eigen::VectorXd& f) {
    flat(system_.x) = x;
    evaluate(false);
    f = flat(f_);
    if (!loads_.force.empty()) f += flat(loads_.force);
    if (!loads_.imposed.empty())
      for (size_t i = 0; i < system_.x.size(); ++i)
        for (int a = 0; a < 3; ++a)
          if (loads_.imposed[i][a]) f[static_cast<Eigen::Index>(3 * i) + a] = 0;
    rest.force = f.cwiseAbs().maxCoeff();
    return rest.force <= force;
  };
  Eigen::VectorXd x = flat(system_.x);
  if (!(stiffness > 0)) {
    Eigen::VectorXd f;
    rest.reached = forces(x, f);
    rest.evaluations = 1;
    return rest;
  }
  const FireResult result = fire(
      x, forces, {.stiffness = stiffness, .longest_step = 0.05 * tersoff_.tersoff().cutoff(), .most = most});
  rest.reached = result.at_rest, rest.evaluations = result.evaluations;
  return rest;
}

void AtomMotion::deform(const Mat3& deformation) {
  system_.box.edges = deformation * system_.box.edges;
  for (Vec3& x : system_.x) x = deformation * x;
  evaluate(false);
}

double AtomMotion::potential_energy() {
  if (!sums_) evaluate(true);
  return tersoff_.energy();
}

double AtomMotion::kinetic_energy() const {
  double sum = 0;
  for (size_t i = 0; i < system_.v.size(); ++i) sum += mass_of(i) * system_.v[i].squaredNorm() / 2;
  return sum;
}

Vec3 AtomMotion::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (size_t i = 0; i < system_.v.size(); ++i) sum += mass_of(i) * system_.v[i];
  return sum;
}

Mat3 AtomMotion::virial() {
  if (!sums_) evaluate(true);
  return tersoff_.virial();
}

Mat3 AtomMotion::virial_of(size_t atom) {
  if (!sums_) evaluate(true);
  return tersoff_.virial_of(atom);
}

}  // namespace cuboct
