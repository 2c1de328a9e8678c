// SPDX-License-Identifier: MIT
#include "model/real/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "model/base/error.h"
#include "model/base/parallel.h"
#include "model/contract/law_energies.h"
#include "model/real/pair_kernel.h"
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
  engine_->place(body, step_);
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

namespace {

// Pairs that are gathered, so that one call of a law serves many; those of a particle i follow one another,
// by ascending j.
struct PairBatch {
  static constexpr size_t kMost = 1024;
  std::vector<uint32_t> i, j;
  std::vector<Vec3> d;         // x[j] - x[i], m
  std::vector<double> r2;      // m^2
  std::vector<double> values;  // what a law says of them
};

// Calls see(batch) for the pairs inside the cutoff: each once for each of its two particles, or with `once`
// for the one of less id; all of one particle in one thread.
template <class See>
void for_each_batch(const NearList& list, const std::vector<Vec3>& x, double cutoff, bool once, int threads,
                    const See& see) {
  const std::span<const uint32_t> ids = list.order();
  const std::vector<PairRows>& parts = list.parts();
  const size_t groups = parts.back().first_group + parts.back().begin.size() - 1;
  const size_t lanes = groups == 0 ? 1 : list.slots() / groups;
  const double cutoff2 = cutoff * cutoff;
  for_each_part(parts.size(), threads, [&](size_t p, int) {
    const PairRows& part = parts[p];
    PairBatch batch;
    const auto hand_on = [&] {
      see(batch);
      batch.i.clear(), batch.j.clear(), batch.d.clear(), batch.r2.clear();
    };
    for (size_t g = 0; g + 1 < part.begin.size(); ++g) {
      for (size_t lane = 0; lane < lanes; ++lane) {
        const size_t slot = (part.first_group + g) * lanes + lane;
        if (slot >= ids.size()) break;
        const uint32_t i = ids[slot];
        for (size_t row = part.begin[g]; row < part.begin[g + 1]; ++row) {
          const uint32_t j = ids[part.entry[row * lanes + lane] / 4];
          if (once && j <= i) continue;
          const Vec3 d = list.difference(x[i], x[j]);
          const double r2 = d.squaredNorm();
          if (!(r2 > 0 && r2 < cutoff2)) continue;
          batch.i.push_back(i), batch.j.push_back(j), batch.d.push_back(d), batch.r2.push_back(r2);
        }
        if (batch.i.size() >= PairBatch::kMost) hand_on();
      }
    }
    hand_on();
  });
}

// Whether all pairs have the force of one law, as it is.
bool one_law(const Rule& rule) {
  const auto ones = [](const std::vector<double>& row) {
    return std::ranges::all_of(row, [](double strength) { return strength == 1; });
  };
  return rule.laws() == 1 && rule.contact.empty() && std::ranges::all_of(rule.strength, ones);
}

}  // namespace

double Reference::potential_energy() const {
  if (const RoundsTerms* terms = engine_->terms()) return terms->energy();
  const std::vector<Vec3>& x = body().x;
  std::vector<double> of(x.size());
  const bool alike = one_law(rule_);
  for_each_batch(engine_->list(), x, rule_.cutoff(), true, threads_, [&](PairBatch& pairs) {
    pairs.values.resize(pairs.r2.size());
    for (double& r2 : pairs.r2) r2 = std::sqrt(r2);
    if (alike)
      energies_of(*rule_.law, pairs.r2, pairs.values);
    else
      for (size_t k = 0; k < pairs.i.size(); ++k)
        pairs.values[k] = rule_.pair_energy(body_.type[pairs.i[k]], body_.type[pairs.j[k]], pairs.r2[k]);
    for (size_t k = 0; k < pairs.i.size(); ++k) of[pairs.i[k]] += pairs.values[k];
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
  const bool damps = rule_.damping.coefficient > 0, alike = one_law(rule_);
  const LawTerms<double> law(rule_.law_at(0));
  const std::vector<Vec3>& x = body().x;
  for_each_batch(engine_->list(), x, rule_.cutoff(), false, threads_, [&](PairBatch& pairs) {
    if (alike) pair_over_r(law, pairs.r2, pairs.values);
    for (size_t n = 0; n < pairs.i.size(); ++n) {
      const uint32_t i = pairs.i[n], j = pairs.j[n];
      const Vec3& d = pairs.d[n];
      const double r = alike && !damps ? 0 : std::sqrt(pairs.r2[n]);
      double k = alike ? pairs.values[n] : 0;
      if (!alike) {
        if (r >= rule_.reach(body_.type[i], body_.type[j])) continue;
        k = rule_.law_of(body_.type[i], body_.type[j]).force(r) / r;
      }
      if (damps) k -= rule_.damping_over_r2(r) * (body_.v[j] - body_.v[i]).dot(d);
      k *= rule_.strength_of(body_.type[i], body_.type[j]);
      // A pair that pulls (k < 0) is under tension along d.
      stress[i] -= k * d * d.transpose();
    }
  });
  for (Mat3& of : stress) of /= 2 * volume;
  return stress;
}

}  // namespace cuboct
