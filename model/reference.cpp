// SPDX-License-Identifier: MIT
#include "model/reference.h"

#include <fmt/format.h>

#include <stdexcept>

#include "model/error.h"

namespace cuboct {

Reference::Reference(const Rule& rule, const Body& body, const Periodic& periodic,
                     const RealOptions& options)
    : rule_(rule), body_(body), cells_(rule.law->cutoff(), periodic), integrator_(options.integrator) {
  const size_t n = body_.size();
  if (body_.v.size() != n || body_.type.size() != n || (!body_.u.empty() && body_.u.size() != n)) {
    throw InputError(fmt::format("a body of {} positions has {} velocities, {} types and {} displacements", n,
                                 body_.v.size(), body_.type.size(), body_.u.size()));
  }
  for (size_t i = 0; i < n; ++i) {
    if (body_.type[i] >= rule_.types.size()) {
      throw InputError(
          fmt::format("particle {} has type {}, but the rule has {}", i, body_.type[i], rule_.types.size()));
    }
  }
  for (const ParticleType& type : rule_.types) pd_ = pd_ || type.pd;
  if (pd_ && body_.u.empty()) body_.u.assign(n, Vec3::Zero());
  sort();
  if (integrator_ == Integrator::velocity_verlet) a_ = accelerations();
}

template <class On>
void Reference::for_each_force(On&& on) const {
  const PairLaw& law = *rule_.law;
  const bool damps = rule_.damping.coefficient > 0;
  cells_.for_each_pair(body_.x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    double k = law.force(r) / r;
    if (damps) k -= rule_.damping_over_r2(r) * (body_.v[j] - body_.v[i]).dot(d);
    on(i, j, d, r, k * rule_.strength_of(body_.type[i], body_.type[j]));
  });
}

std::vector<Vec3> Reference::forces() const {
  std::vector<Vec3> f(body_.size(), Vec3::Zero());
  for_each_force([&](uint32_t i, uint32_t j, const Vec3& d, double, double k) {
    f[i] -= k * d;
    f[j] += k * d;
  });
  return f;
}

std::vector<Vec3> Reference::accelerations() const {
  std::vector<Vec3> a = forces();
  for (size_t i = 0; i < a.size(); ++i) {
    const ParticleType& type = rule_.types[body_.type[i]];
    if (type.pd) a[i] -= type.kp * body_.u[i] + type.kd * (body_.v[i] - type.velocity);
    a[i] = a[i] / rule_.mass + type.gravity;
  }
  return a;
}

void Reference::kick(double dt) {
  for (size_t i = 0; i < body_.size(); ++i) {
    const ParticleType& type = rule_.types[body_.type[i]];
    body_.v[i] += a_[i] * dt;
    for (int axis = 0; axis < 3; ++axis) {
      if (type.imposed[axis]) body_.v[i][axis] = type.velocity[axis];
    }
  }
}

void Reference::drift(double dt) {
  for (size_t i = 0; i < body_.size(); ++i) {
    const ParticleType& type = rule_.types[body_.type[i]];
    if (type.pd) body_.u[i] += (body_.v[i] - type.velocity) * dt;
    body_.x[i] += body_.v[i] * dt;
  }
  sort();
}

void Reference::sort() {
  try {
    cells_.build(body_.x);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("step {}: {}; is dt too long?", step_, error.what()));
  }
}

void Reference::step(uint64_t steps) {
  for (uint64_t n = 0; n < steps; ++n) {
    if (integrator_ == Integrator::semi_implicit_euler) {
      a_ = accelerations();
      kick(rule_.dt);
      drift(rule_.dt);
    } else {
      kick(rule_.dt / 2);
      drift(rule_.dt);
      a_ = accelerations();
      kick(rule_.dt / 2);
    }
    ++step_;
  }
}

double Reference::potential_energy() const {
  double sum = 0;
  cells_.for_each_pair(body_.x, [&](uint32_t i, uint32_t j, const Vec3&, double r) {
    sum += rule_.law->energy(r) * rule_.strength_of(body_.type[i], body_.type[j]);
  });
  return sum;
}

double Reference::kinetic_energy() const {
  double sum = 0;
  for (const Vec3& v : body_.v) sum += v.squaredNorm();
  return rule_.mass * sum / 2;
}

Vec3 Reference::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : body_.v) sum += v;
  return rule_.mass * sum;
}

std::vector<Mat3> Reference::virial_stress(double volume) const {
  std::vector<Mat3> stress(body_.size(), Mat3::Zero());
  // A pair that pulls (k < 0) is under tension along d.
  for_each_force([&](uint32_t i, uint32_t j, const Vec3& d, double, double k) {
    const Mat3 half = -k / (2 * volume) * d * d.transpose();
    stress[i] += half;
    stress[j] += half;
  });
  return stress;
}

}  // namespace cuboct
