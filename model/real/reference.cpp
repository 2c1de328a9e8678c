// SPDX-License-Identifier: MIT
#include "model/real/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "model/base/error.h"
#include "model/base/parallel.h"
#include "model/real/real_engine.h"

namespace cuboct {

int reference_threads(size_t particles) {
  constexpr size_t kEach = 2000;
  return static_cast<int>(std::clamp<size_t>(particles / kEach, 1, static_cast<size_t>(usable_cores())));
}

Reference::Reference(const Rule& rule, const Body& body, const Periodic& periodic, const RealOptions& options)
    : rule_(rule), threads_(options.threads), step_(options.first_step), body_(body) {
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
  bool pd = false;
  for (const ParticleType& type : rule_.types) pd = pd || type.pd;
  if (pd && body_.u.empty()) body_.u.assign(n, Vec3::Zero());
  engine_ = make_real_engine(rule_, body_, periodic, options);
}
Reference::~Reference() = default;
Reference::Reference(Reference&&) noexcept = default;
Reference& Reference::operator=(Reference&&) noexcept = default;

void Reference::step(uint64_t steps) {
  stale_ = true;
  for (uint64_t n = 0; n < steps; ++n) {
    engine_->step(step_);
    ++step_;
  }
}

void Reference::place(const Body& body) {
  stale_ = true;
  engine_->place(body);
}

void Reference::give_way() { engine_->give_way(); }

const RoundsTerms* Reference::terms() const { return engine_->terms(); }

const Body& Reference::body() const {
  if (stale_) engine_->read(body_);
  stale_ = false;
  return body_;
}

std::vector<Vec3> Reference::forces() const { return engine_->forces(); }
double Reference::largest_speed() const { return engine_->largest_speed(); }
uint64_t Reference::lists_made() const { return engine_->lists_made(); }
const char* Reference::simd() { return pair_simd(); }

template <class On>
void Reference::for_each_neighbour(On&& on) const {
  const NearList& list = engine_->list();
  const std::vector<Vec3>& x = body().x;
  const std::span<const uint32_t> ids = list.order();
  const std::vector<PairRows>& parts = list.parts();
  const size_t groups = parts.back().first_group + parts.back().begin.size() - 1;
  const size_t lanes = groups == 0 ? 1 : list.slots() / groups;
  const double cutoff2 = rule_.cutoff() * rule_.cutoff();
  for_each_part(parts.size(), threads_, [&](size_t p, int) {
    const PairRows& part = parts[p];
    for (size_t g = 0; g + 1 < part.begin.size(); ++g) {
      for (size_t lane = 0; lane < lanes; ++lane) {
        const size_t slot = (part.first_group + g) * lanes + lane;
        if (slot >= ids.size()) break;
        for (size_t row = part.begin[g]; row < part.begin[g + 1]; ++row) {
          const uint32_t i = ids[slot], j = ids[part.entry[row * lanes + lane] / 4];
          const Vec3 d = list.difference(x[i], x[j]);
          const double r2 = d.squaredNorm();
          if (r2 > 0 && r2 < cutoff2) on(i, j, d, r2);
        }
      }
    }
  });
}

double Reference::potential_energy() const {
  if (const RoundsTerms* terms = engine_->terms()) return terms->energy();
  std::vector<double> of(body().size());
  for_each_neighbour([&](uint32_t i, uint32_t j, const Vec3&, double r2) {
    if (i < j) of[i] += rule_.pair_energy(body_.type[i], body_.type[j], std::sqrt(r2));
  });
  return std::accumulate(of.begin(), of.end(), 0.0);
}

double Reference::kinetic_energy() const {
  double sum = 0;
  for (size_t i = 0; i < body().size(); ++i)
    sum += rule_.relative_mass(body_.type[i]) * body_.v[i].squaredNorm();
  return rule_.mass * sum / 2;
}

Vec3 Reference::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (size_t i = 0; i < body().size(); ++i) sum += rule_.relative_mass(body_.type[i]) * body_.v[i];
  return rule_.mass * sum;
}

std::vector<Mat3> Reference::virial_stress(double volume) const {
  std::vector<Mat3> stress(body().size(), Mat3::Zero());
  if (const RoundsTerms* terms = engine_->terms()) {
    for (size_t i = 0; i < stress.size(); ++i) stress[i] = terms->stress(i, volume);
    return stress;
  }
  const bool damps = rule_.damping.coefficient > 0;
  for_each_neighbour([&](uint32_t i, uint32_t j, const Vec3& d, double r2) {
    const double r = std::sqrt(r2);
    if (r >= rule_.reach(body_.type[i], body_.type[j])) return;
    double k = rule_.law_of(body_.type[i], body_.type[j]).force(r) / r;
    if (damps) k -= rule_.damping_over_r2(r) * (body_.v[j] - body_.v[i]).dot(d);
    k *= rule_.strength_of(body_.type[i], body_.type[j]);
    // A pair that pulls (k < 0) is under tension along d.
    stress[i] += -k / (2 * volume) * d * d.transpose();
  });
  return stress;
}

}  // namespace cuboct
