// SPDX-License-Identifier: MIT
// Pair kicks in floats and doubles against the pair law in doubles, within bounds by rounding analysis.
#include "emu/gpu/real/real_rule.h"

#include <gtest/gtest.h>

#include <limits>

#include "emu/gpu/real/real_tables.h"
#include "model/base/error.h"
#include "tests/gpu/laws.h"
#include "tests/gpu/pair_kick.h"
#include "tests/support/refused_with.h"

namespace cuboct::gpu {
namespace {

using test::NamedRule;

template <class Real>
constexpr double kUnit = std::numeric_limits<Real>::epsilon() / 2;  // u: half an ulp of 1

// The device's errors at their worst, on the host: the exact result times 1 + error or 1 - error, and
// rounded.
struct WorstRoots {
  static float inverse(float a) { return off(1 / static_cast<double>(a), a, 0x1p-23); }
  static float inverse_root(float a) { return off(1 / std::sqrt(static_cast<double>(a)), a, 0x1.85p-23); }
  static double inverse(double a) { return FastRoots::inverse(a); }
  static double inverse_root(double a) { return FastRoots::inverse_root(a); }

 private:
  static float off(double value, float a, double error) {
    const bool up = (std::bit_cast<uint32_t>(a) * 2654435761u >> 31) != 0;
    return static_cast<float>(value * (up ? 1 + error : 1 - error));
  }
};

TEST(FastRoots, DoublesAreWithinFourUnits) {
  double worst = 0;
  for (int k = 0; k < 200000; ++k) {
    const double a = std::exp2(-40.0 + 44.0 * k / 200000);
    const long double inverse = 1.0L / a, root = 1.0L / std::sqrt(static_cast<long double>(a));
    worst = std::max(worst, static_cast<double>(std::abs(FastRoots::inverse(a) / inverse - 1)));
    worst = std::max(worst, static_cast<double>(std::abs(FastRoots::inverse_root(a) / root - 1)));
  }
  EXPECT_LE(worst, 4 * kUnit<double>);
}

// The bound on the error of a pair's kick, cutoffs per step, along the pair; r and all else in a RealRule's
// units. To first order in u, as all errors here are; |.| of each part summed.
//   rho   r2 = d.d: a product and two sums of nothing negative           3u
//   i, g  of inverse and inverse_root: on the device, and one rounding   floats 3u, 4.1u; doubles 4u, 4u
//   a     of the coefficients: one rounding in floats; in doubles also those of their own making, of the
//         law's, which is the reference, and of its argument r           floats 1u, doubles 10u
//   q     1/r2: rho + i of Lennard-Jones; else y^2, y = 1/r: 2 (rho/2 + g) + u
// Lennard-Jones: f/r = q^4 (A q^3 - B), with A q^7 = R and B q^4 = S. R takes 7 q and 6 products, difference
//   and last product two more, the sum with a shift's offset one; S less:
//     (7 q + 9u + a) (R + S) r                          shifted: + (rho/2 + g + 2u + a) |offset|
// Pieces: r = r2 y has rho/2 + g + u, the piece's begin u + a, their difference u; so t is off by
//   T = (rho/2 + g + 3u + a) r, and f by |f'| T, of the piece itself and of the choice of the piece: at a
//   joint f and f' are continuous. With f = sum of c_k t^k by Horner, 6 roundings on the way of the longest
//   term, and y, two products at the end:
//     |f'| T + (6u + a) sum |c_k t^k| + (rho/2 + g + 2u) |f|
// Arcs: z = 1 + c t; (2u + a) |z - 1| + u z of it are not by t. s = z y(z): half of that over z, g + u; 1 +
// s:
//   u; inverse and product: i + u. Against p = t/(1 + s), f = sum of c_k p^k:
//     dp = |t|/(2 s (1 + s)^2) ((2u + a) |z - 1| + u z) + |p| (g + i + 3u)
//     |f'| T + |df/dp| dp + (4u + a) sum |c_k p^k| + (rho/2 + g + 2u) |f|
// Damping D rest^2 q (w.d) r, rest = 1 - r2: rest is off by rho r2 + u, twice; q as above, four products and
// a:
//     D q |w|.|d| r (2 rest (rho r2 + u) + rest^2 (q + 4u + a + 3u))
// All times the strength with u + a, k d with u, the sum into 0 none.
template <class Real>
double bound_of(const Rule& law_of, const RealTables<Real>& tables, double r, double w_dot_d, int i, int j) {
  const RealRule<Real> rule = tables.rule();
  const double u = kUnit<Real>, rho = 3 * u;
  const bool is_float = sizeof(Real) == 4;
  const double inv = (is_float ? 3.0 : 4.0) * u, root = (is_float ? 4.1 : 4.0) * u,
               a = (is_float ? 1 : 10) * u;
  const PairLaw& law = law_of.law_of(i, j);
  const RealLaw<Real>& terms = rule.laws[law_of.law_index_of(i, j)];
  const Real* const cache = rule.cache + terms.first;
  const double core = law.core() / tables.length;
  const double near = std::max(r, core), r2 = near * near;
  const double q_error = has_pieces(terms.kind) ? 2 * (rho / 2 + root) + u : rho + inv;
  double error = 0, f = 0;
  if (r >= law.cutoff() / tables.length) {
    // Nothing but damping is left.
  } else if (!has_pieces(terms.kind)) {
    const double q = 1 / r2, q4 = q * q * q * q;
    const double R = static_cast<double>(terms.repulsion) * q4 * q * q * q,
                 S = static_cast<double>(terms.attraction) * q4,
                 O = std::abs(static_cast<double>(terms.offset));
    error = (7 * q_error + 9 * u + a) * (R + S) * near + (rho / 2 + root + 2 * u + a) * O;
    f = (R + S) * near + O;
  } else {
    const int piece = piece_of<true>(terms, cache, static_cast<Real>(std::min(r2, 1.0)));
    const Real* const at = cache + 4 * piece;
    const auto c = [&](int k) { return static_cast<double>(at[k]); };
    const double t = near - static_cast<double>(cache[terms.begin_at + piece]);
    const double t_error = (rho / 2 + root + 3 * u + a) * near;
    const double in_slope = tables.length / tables.force;
    // Of both sides, as rounding may choose either.
    const double aside = 4 * t_error * tables.length, at_r = near * tables.length;
    const double slope =
        in_slope * std::max(std::abs(law.slope(std::max(at_r - aside, core * tables.length))),
                            std::abs(law.slope(std::min(at_r + aside, law.cutoff() * (1 - 1e-12)))));
    double sum = 0;
    if (is_arc(terms.kind)) {
      const double z = 1 + c(3) * t, s = std::sqrt(z), p = t / (1 + s);
      const double p_error =
          std::abs(t) / (2 * s * (1 + s) * (1 + s)) * ((2 * u + a) * std::abs(z - 1) + u * z) +
          std::abs(p) * (root + inv + 3 * u);
      sum = std::abs(c(0)) + std::abs(c(1) * p) + std::abs(c(2) * p * p);
      error = (std::abs(c(1)) + 2 * std::abs(c(2) * p)) * p_error + (4 * u + a) * sum;
    } else {
      sum = std::abs(c(0)) + std::abs(c(1) * t) + std::abs(c(2) * t * t) + std::abs(c(3) * t * t * t);
      error = (6 * u + a) * sum;
    }
    error += slope * t_error + (rho / 2 + root + 2 * u) * sum;
    f = sum;
  }
  // Below the core f/r is that of the core.
  error *= r / near;
  f *= r / near;
  if (rule.damped && r < 1) {
    // The rule's core, and 1/r2 as each kind of rule has it.
    const double from = std::max(r, law_of.core() / tables.length), from2 = from * from;
    const double rest = 1 - from2, scale = static_cast<double>(rule.damping) / from2 * w_dot_d * r;
    const double inverse_error = rule.kind == LawKind::several ? rho + inv : q_error;
    error += scale * (2 * rest * (rho * from2 + u) + rest * rest * (inverse_error + 7 * u + a));
    f += scale * rest * rest;
  }
  const double strength = law_of.strength_of(i, j);
  return strength * (error + (2 * u + a) * f);
}

// Distances in cutoffs of the law: all of them, and close to the core, the joints and the cutoff.
std::vector<double> distances(const PairLaw& law, double unit) {
  std::vector<double> r{0};
  const double cutoff = law.cutoff();
  for (int k = 1; k <= 5000; ++k) r.push_back(1.1 * k / 5000);
  std::vector<double> special{law.core() / cutoff, 1.0};
  const LawForm form = law.form();
  if (const auto* cubics = std::get_if<std::vector<CubicPiece>>(&form))
    for (const CubicPiece& p : *cubics) special.push_back(p.r / cutoff);
  if (const auto* arcs = std::get_if<std::vector<ArcPiece>>(&form))
    for (const ArcPiece& p : *arcs) special.push_back(p.r / cutoff);
  for (const double s : special)
    for (const double by : {1e-3, 1e-5, 300 * unit, 10 * unit, 3 * unit, unit, 0.0}) {
      r.push_back(s * (1 - by));
      r.push_back(s * (1 + by));
    }
  return r;
}

struct Worst {
  double of_bound = 0;    // error over bound
  double of_largest = 0;  // error over u times the largest kick of the sweep
  double of_scale = 0;    // the same with r |df/dr| where that is larger: what a rounding of r changes
  size_t pairs = 0, inside = 0;
};

template <class Real, class Roots>
Worst sweep(const NamedRule& named) {
  const Rule& law_of = named.rule;
  const RealTables<Real> tables(law_of);
  const RealRule<Real> rule = tables.rule();
  const double u = kUnit<Real>;
  Worst worst;
  double largest = 0, scale = 0, largest_error = 0;
  std::mt19937_64 generator(7);
  const int types = rule.type_count;
  std::vector<double> all;
  for (size_t k = 0; k < law_of.laws(); ++k)
    for (const double r : distances(law_of.law_at(k), u))
      all.push_back(r * (law_of.law_at(k).cutoff() / tables.length));
  for (const double wanted : all) {
    Vec3 direction = test::random_vector(generator);
    direction.normalize();
    Vec3 relative = 0.01 * test::random_vector(generator);
    const int i = static_cast<int>(generator() % types), j = static_cast<int>(generator() % types);
    Real d[3], w[3], back_d[3], back_w[3], kick[3] = {}, back[3] = {};
    Vec3 exact_d, exact_w;
    for (int axis = 0; axis < 3; ++axis) {
      d[axis] = static_cast<Real>(wanted * direction[axis]);
      w[axis] = static_cast<Real>(relative[axis]);
      back_d[axis] = -d[axis];
      back_w[axis] = -w[axis];
      exact_d[axis] = static_cast<double>(d[axis]);
      exact_w[axis] = static_cast<double>(w[axis]);
    }
    const auto pair = [&](const Real* at, const Real* v, int of, int by, Real* sum) {
      return with_kinds(rule, [&]<LawKind kKind, bool kDamped, bool kScaled>() {
        return add_pair_kick<kKind, kDamped, kScaled, Roots>(rule, rule.cache, at, v, of, by, sum);
      });
    };
    const bool inside = pair(d, w, i, j, kick);
    EXPECT_EQ(pair(back_d, back_w, j, i, back), inside);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_TRUE(std::isfinite(kick[axis])) << named.name << " at " << wanted;
      // By value: what is 0 may have either sign.
      EXPECT_EQ(kick[axis], -back[axis]) << named.name << " at " << wanted << " cutoffs, axis " << axis;
    }
    const double r = exact_d.norm();
    ++worst.pairs;
    worst.inside += inside;
    const double reach = law_of.reach(i, j) / tables.length;
    const PairLaw& law = law_of.law_of(i, j);
    // Rounding says which side of the reach, or of a cutoff where the force jumps, it is.
    if (std::abs(r - reach) < 4 * u || std::abs(r - law.cutoff() / tables.length) < 4 * u) continue;
    EXPECT_EQ(inside, r < reach) << named.name << " at " << wanted;
    Vec3 expected = Vec3::Zero();
    if (r > 0 && r < reach) {
      const double metres = r * tables.length;
      const double k = law.force(metres) / metres - law_of.damping_over_r2(metres) * tables.length *
                                                        tables.velocity * exact_w.dot(exact_d);
      expected = -k * law_of.strength_of(i, j) * tables.length / tables.force * exact_d;
    }
    const Vec3 got(static_cast<double>(kick[0]), static_cast<double>(kick[1]), static_cast<double>(kick[2]));
    const double error = (got - expected).norm();
    const double bound =
        r < reach ? bound_of(law_of, tables, r, exact_w.cwiseAbs().dot(exact_d.cwiseAbs()), i, j) : 0;
    EXPECT_LE(error, bound) << named.name << " at " << wanted << " cutoffs: " << got << " instead of "
                            << expected;
    if (bound > 0) worst.of_bound = std::max(worst.of_bound, error / bound);
    largest = std::max(largest, expected.norm());
    scale = std::max({scale, expected.norm(),
                      std::abs(law.slope(r * tables.length)) * r * tables.length / tables.force *
                          law_of.strength_of(i, j)});
    largest_error = std::max(largest_error, error);
  }
  worst.of_largest = largest_error / (largest * u);
  worst.of_scale = largest_error / (scale * u);
  return worst;
}

// 16 u: 8 ulps of the largest force, or change of it with ln r.
template <class Real, class Roots>
void expect_within_bounds(const std::vector<NamedRule>& rules) {
  for (const NamedRule& named : rules) {
    const Worst worst = sweep<Real, Roots>(named);
    EXPECT_GT(worst.inside, 3900u) << named.name;
    EXPECT_LE(worst.of_scale, 16) << named.name;
    // A bound that is never nearly met shows nothing.
    EXPECT_GE(worst.of_bound, 0.02) << named.name;
    if (testing::Test::HasFailure()) return;
    std::printf("  %-28s error/bound %.2f   error %.1f u of the largest kick\n", named.name.c_str(),
                worst.of_bound, worst.of_largest);
  }
}

TEST(RealRule, SeveralLaws) {
  const std::vector<NamedRule> rules{test::several_laws()};
  EXPECT_EQ(RealTables<float>(rules[0].rule).rule().kind, LawKind::several);
  expect_within_bounds<float, FastRoots>(rules);
  expect_within_bounds<float, WorstRoots>(rules);
  expect_within_bounds<double, FastRoots>(rules);
}
TEST(RealRule, MadeLawsInFloats) { expect_within_bounds<float, FastRoots>(test::made_rules()); }
TEST(RealRule, MadeLawsInFloatsWithTheDevicesWorstRoots) {
  expect_within_bounds<float, WorstRoots>(test::made_rules());
}
TEST(RealRule, MadeLawsInDoubles) { expect_within_bounds<double, FastRoots>(test::made_rules()); }
TEST(RealRule, LawsOfTheScenes) {
  const std::vector<NamedRule> rules = test::scene_rules();
  ASSERT_GT(rules.size(), 25u);
  expect_within_bounds<float, WorstRoots>(rules);
  expect_within_bounds<double, FastRoots>(rules);
}

TEST(RealRule, KindsAreThoseOfTheLaws) {
  const auto kind_of = [](const std::string& name) {
    for (const NamedRule& named : test::made_rules())
      if (named.name == name) return RealTables<float>(named.rule).rule().kind;
    throw std::runtime_error("no rule " + name);
  };
  EXPECT_EQ(kind_of("lj"), LawKind::lennard_jones);
  EXPECT_EQ(kind_of("lj_smooth"), LawKind::shifted_lennard_jones);
  EXPECT_EQ(kind_of("ductile"), LawKind::cubic);
  EXPECT_EQ(kind_of("cubic_many"), LawKind::cubic);
  EXPECT_EQ(kind_of("cubic_crowded"), LawKind::crowded_cubic);
  EXPECT_EQ(kind_of("b_spline_many"), LawKind::arc);
  EXPECT_EQ(kind_of("b_spline_crowded"), LawKind::crowded_arc);
}

// Every piece by its index against the joints one by one.
TEST(RealRule, FindsThePiece) {
  for (const NamedRule& named : test::made_rules()) {
    const RealTables<float> tables(named.rule);
    const RealRule<float> rule = tables.rule();
    if (!has_pieces(rule.kind)) continue;
    std::vector<float> joints;
    for (const float* at = rule.cache + rule.joint_at + 1; *at < 2; ++at) joints.push_back(*at);
    EXPECT_EQ(tables.cache.size() % 4, 0u);
    EXPECT_LE(tables.cache.size(), 3000u);
    const auto expect_piece = [&](float r2) {
      if (r2 < rule.core2 || r2 > 1) return;
      const auto piece = std::upper_bound(joints.begin(), joints.end(), r2) - joints.begin();
      const int found = is_crowded(rule.kind) ? piece_of<true>(rule, rule.cache, r2)
                                              : piece_of<false>(rule, rule.cache, r2);
      ASSERT_EQ(found, piece) << named.name << " at " << r2;
    };
    for (int k = 0; k <= 20000; ++k) expect_piece(static_cast<float>(k) / 20000);
    for (const float joint : joints)
      for (const float r2 : {std::nextafter(joint, 0.0f), joint, std::nextafter(joint, 1.0f)})
        expect_piece(r2);
    expect_piece(rule.core2);
  }
}

struct FormlessLaw final : PairLaw {
  double force(double) const override { return 0; }
  double energy(double) const override { return 0; }
  double slope(double) const override { return 0; }
  double cutoff() const override { return 1; }
  double core() const override { return 0.5; }
};

template <class Real>
std::string refusal(std::shared_ptr<const PairLaw> law) {
  return refused_with([&] { RealTables<Real>(test::simple_rule(std::move(law), 1, 1)); });
}

TEST(RealRule, RefusesWhatItCannotHold) {
  EXPECT_EQ(refusal<float>(std::make_shared<FormlessLaw>()),
            "the pair law has no closed form, which floats and doubles on a GPU need\n"
            "  hint: precision fixed runs it; so do floats where the force is one table's value at r");
  const auto hard = lennard_jones(1, 1, 2.5, 1e-5);
  EXPECT_EQ(refusal<float>(hard),
            "the pair law's force at its core, 1e-05 m, is beyond the range of a float\n"
            "  hint: a larger core, or doubles");
  EXPECT_EQ(refusal<double>(hard), "accepted");
  EXPECT_EQ(refusal<float>(lennard_jones(1, 1, 2.5, 1e-20)),
            "the pair law's core is 4e-21 of its cutoff, whose square no float holds\n"
            "  hint: a larger core, or doubles");
}

}  // namespace
}  // namespace cuboct::gpu
