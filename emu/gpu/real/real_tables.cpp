// SPDX-License-Identifier: MIT
#include "emu/gpu/real/real_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "model/base/error.h"

namespace cuboct::gpu {
namespace {

// Bins per octave of r^2: as few as keep joints apart, so that they stay in a few rows of banks. 1024 bins in
// all are 8 KiB of floats.
constexpr int kLeastBits = 3, kMostBits = 10, kMostBins = 1024;

template <class Real>
constexpr int kMantissaBits = sizeof(Real) == 4 ? 23 : 20;  // of the word that bin_bits takes

template <class Real>
constexpr const char* kName = sizeof(Real) == 4 ? "float" : "double";
template <class Real>
constexpr const char* kHint = sizeof(Real) == 4 ? "a larger core, or doubles" : "a larger core";

template <class Real>
Real index_as_real(size_t index) {
  if constexpr (sizeof(Real) == 4)
    return std::bit_cast<float>(static_cast<uint32_t>(index));
  else
    return std::bit_cast<double>(static_cast<uint64_t>(index));
}

// Where the bin of these bits begins.
float begin_of_bin(int bits, int shift, float) {
  return std::bit_cast<float>(static_cast<uint32_t>(bits) << shift);
}
double begin_of_bin(int bits, int shift, double) {
  return std::bit_cast<double>(static_cast<uint64_t>(static_cast<uint32_t>(bits) << shift) << 32);
}

}  // namespace

template <class Real>
RealTables<Real>::RealTables(const Rule& rule) {
  length = rule.cutoff();
  velocity = length / rule.dt;
  force = rule.mass * velocity / rule.dt;
  const auto real = [](double value) { return static_cast<Real>(value); };
  static_assert(kLaws == kMostLaws);
  for (size_t k = 0; k < rule.laws(); ++k) rule_.laws[k] = take_law(rule.law_at(k));
  static_cast<RealLaw<Real>&>(rule_) = rule_.laws[0];
  const bool several = rule.laws() > 1;
  if (several) {
    rule_.kind = LawKind::several;
    rule_.core2 = real(rule.core() * rule.core() / (length * length));
    rule_.cutoff2 = 1;
    rule_.scaled = true;
  }
  rule_.cache_size = static_cast<int>(cache.size());
  rule_.damping = real(rule.damping.coefficient * rule.dt / rule.mass);
  rule_.damped = rule.damping.coefficient > 0;
  for (const ParticleType& from : rule.types) {
    RealType<Real> type;
    const double mass = rule.mass_of(static_cast<int>(types.size()));
    type.weight = real(rule.mass / mass);
    rule_.constrained |= mass != rule.mass;
    type.kp = real(from.kp * rule.dt * rule.dt / mass);
    type.kd = real(from.kd * rule.dt / mass);
    type.pd = from.pd;
    rule_.pd |= from.pd;
    rule_.constrained |= from.pd;
    for (int axis = 0; axis < 3; ++axis) {
      type.gravity[axis] = real(from.gravity[axis] * rule.dt / velocity);
      type.velocity[axis] = real(from.velocity[axis] / velocity);
      type.imposed[axis] = from.imposed[axis];
      rule_.constrained |= from.imposed[axis] || from.gravity[axis] != 0;
    }
    types.push_back(type);
  }
  rule_.type_count = static_cast<int>(rule.types.size());
  for (int i = 0; i < rule_.type_count; ++i)
    for (int j = 0; j < rule_.type_count; ++j) {
      const double factor = rule.only_touch(i, j) ? -rule.strength_of(i, j) : rule.strength_of(i, j);
      strength.push_back(real(factor));
      rule_.scaled |= factor != 1;
    }
  for (int i = 0; several && i < rule_.type_count; ++i)
    for (int j = 0; j < rule_.type_count; ++j)
      strength.push_back(real(static_cast<double>(rule.law_index_of(i, j))));
  rule_.contact2 = real(rule.contact_distance * rule.contact_distance / (length * length));
  for (size_t k = 0; k < rule.laws(); ++k) require_range(rule_.laws[k], rule.law_at(k));
}

template <class Real>
RealLaw<Real> RealTables<Real>::take_law(const PairLaw& law) {
  RealLaw<Real> terms;
  terms.first = static_cast<int>(cache.size());
  const double core = law.core() / length;
  terms.core2 = static_cast<Real>(core * core);
  terms.cutoff2 = static_cast<Real>(law.cutoff() * law.cutoff() / (length * length));
  if (terms.core2 < std::numeric_limits<Real>::min())
    throw InputError(
        fmt::format("the pair law's core is {:g} of its cutoff, whose square no {} holds", core, kName<Real>),
        kHint<Real>)
        .about({"law.core", "law"});
  const LawForm form = law.form();
  if (const auto* lj = std::get_if<LennardJonesForm>(&form)) {
    // f/r = 24 epsilon (2 (sigma^2/r^2)^6 - (sigma^2/r^2)^3)/r^2 + offset/r
    const double q = lj->sigma * lj->sigma / (length * length), q3 = q * q * q;
    const double scale = 24 * lj->epsilon / (force * length);
    terms.kind = lj->offset != 0 ? LawKind::shifted_lennard_jones : LawKind::lennard_jones;
    terms.repulsion = static_cast<Real>(2 * scale * q3 * q3);
    terms.attraction = static_cast<Real>(scale * q3);
    terms.offset = static_cast<Real>(lj->offset / force);
  } else if (const auto* cubics = std::get_if<std::vector<CubicPiece>>(&form)) {
    terms.kind = LawKind::cubic;
    take_pieces(terms, *cubics, [&](const CubicPiece& p) {
      return std::array<double, 4>{p.c0 / force, p.c1 * length / force, p.c2 * length * length / force,
                                   p.c3 * length * length * length / force};
    });
  } else if (const auto* arcs = std::get_if<std::vector<ArcPiece>>(&form)) {
    terms.kind = LawKind::arc;
    take_pieces(terms, *arcs, [&](const ArcPiece& p) {
      const double b = 2 * length / p.r1;  // p of over_r is s/b
      return std::array<double, 4>{p.f0 / force, p.f1 * b / force, p.f2 * b * b / force,
                                   p.r2 / length * b * b};
    });
  } else {
    throw InputError("the pair law has no closed form, which floats and doubles on a GPU need",
                     "precision fixed runs it; so do floats where the force is one table's value at r")
        .about({"law.kind", "rule"});
  }
  return terms;
}

template <class Real>
template <class Piece, class Coefficients>
void RealTables<Real>::take_pieces(RealLaw<Real>& terms, const std::vector<Piece>& pieces,
                                   Coefficients coefficients) {
  std::vector<Real> joint2;  // where piece k + 1 begins
  for (size_t k = 1; k < pieces.size(); ++k)
    joint2.push_back(static_cast<Real>(pieces[k].r * pieces[k].r / (length * length)));
  const auto bits_of = [&](Real r2) { return bin_bits(r2, terms.bin_shift); };
  bool crowded = false;
  for (int bits = kLeastBits; bits <= kMostBits; ++bits) {
    const int shift = kMantissaBits<Real> - bits;
    if (bits > kLeastBits && bin_bits(Real(1), shift) - bin_bits(terms.core2, shift) >= kMostBins) break;
    terms.bin_shift = shift;
    crowded = false;
    for (size_t k = 0; k + 1 < joint2.size(); ++k)
      crowded |= bits_of(joint2[k]) == bits_of(joint2[k + 1]) && joint2[k + 1] > terms.core2;
    if (!crowded) break;
  }
  if (crowded) terms.kind = is_arc(terms.kind) ? LawKind::crowded_arc : LawKind::crowded_cubic;
  for (const Piece& piece : pieces)
    for (const double c : coefficients(piece)) cache.push_back(static_cast<Real>(c));
  const int first = bits_of(terms.core2);
  const auto here = [&] { return static_cast<int>(cache.size()) - terms.first; };
  terms.bin_at = here() - 2 * first;
  for (int bits = first; bits <= bits_of(Real(1)); ++bits) {
    const Real begin = std::max(begin_of_bin(bits, terms.bin_shift, Real()), terms.core2);
    const auto next = std::upper_bound(joint2.begin(), joint2.end(), begin);
    const bool inside = next != joint2.end() && bits_of(*next) == bits;
    cache.push_back(inside ? *next : Real(2));
    cache.push_back(index_as_real<Real>(static_cast<size_t>(next - joint2.begin())));
  }
  terms.begin_at = here();
  for (const Piece& piece : pieces) cache.push_back(static_cast<Real>(piece.r / length));
  terms.joint_at = here();
  cache.push_back(0);
  cache.insert(cache.end(), joint2.begin(), joint2.end());
  cache.push_back(2);
  cache.resize((cache.size() + 3) / 4 * 4, Real(0));
}

// The force is largest at the core, or no power of r stands in it.
template <class Real>
void RealTables<Real>::require_range(const RealLaw<Real>& terms, const PairLaw& law) const {
  if (std::isfinite(over_r_of_any<FastRoots>(terms, cache.data(), terms.core2))) return;
  throw InputError(fmt::format("the pair law's force at its core, {:g} m, is beyond the range of a {}",
                               law.core(), kName<Real>),
                   kHint<Real>)
      .about({"law.core", "law"});
}

template struct RealTables<float>;
template struct RealTables<double>;

}  // namespace cuboct::gpu
