// SPDX-License-Identifier: MIT
// Whole steps of small bodies, every pair by brute force, against the reference engine in doubles; energies.
#include <gtest/gtest.h>

#include "emu/gpu/real/energy_table.h"
#include "emu/gpu/real/real_tables.h"
#include "model/analysis/measure.h"
#include "model/real/reference.h"
#include "tests/gpu/laws.h"
#include "tests/gpu/pair_kick.h"

namespace cuboct::gpu {
namespace {

Rule rule_named(const std::string& name) {
  for (const test::NamedRule& named : test::made_rules())
    if (named.name == name) return named.rule;
  throw std::runtime_error("no rule " + name);
}

struct Case {
  std::string name;
  Rule rule;
  Body body;
  Periodic box;
};

// `pitch`: where the law rests, nearly.
Case make_case(const std::string& law, double pitch, bool ring, bool damped, bool constrained) {
  Case c{
      law + (ring ? " periodic" : " open") + (damped ? " damped" : "") + (constrained ? " constrained" : ""),
      rule_named(law),
      {},
      {}};
  const int cells = ring ? 3 : 2;
  c.body = test::fcc_block(cells, pitch);
  if (ring) c.box = test::fcc_box(cells, pitch);
  Rule& rule = c.rule;
  if (!damped) rule.damping.coefficient = 0;
  const double speed = 0.01 * pitch / rule.dt, stiffness = std::abs(rule.law->slope(pitch));
  test::shake(c.body, 0.03 * pitch, speed, 11);
  if (constrained) {
    ParticleType gravity = rule.types[1], held = rule.types[0], moved = rule.types[1];
    gravity.gravity = Vec3(1, -2, 3) * 0.01 * speed / rule.dt;
    held.pd = true;
    held.kp = 0.3 * stiffness;
    held.kd = 0.1 * std::sqrt(stiffness * rule.mass);
    held.velocity = Vec3(0.3, 0.1, -0.2) * speed;
    held.gravity = -gravity.gravity;
    moved.imposed = {true, false, true};
    moved.velocity = Vec3(-0.5, 7, 0) * speed;
    rule.types.insert(rule.types.end(), {gravity, held, moved});
    c.body.u.assign(c.body.size(), Vec3::Zero());
  }
  for (size_t i = 0; i < c.body.size(); ++i)
    c.body.type[i] = static_cast<uint8_t>(i * 7 / 3 % rule.types.size());
  return c;
}

std::vector<Case> cases() {
  const double argon = 3.4e-10 * std::pow(2, 1.0 / 6);
  return {make_case("lj", argon, false, false, false),   make_case("lj_smooth", argon, true, true, false),
          make_case("ductile", 1e-3, true, true, false), make_case("ductile", 1e-3, false, true, true),
          make_case("masses", 1e-3, true, true, false),  make_case("masses", 1e-3, false, true, true),
          make_case("brittle", 1e-3, true, false, true), make_case("cubic_crowded", 1e-3, false, true, false),
          make_case("b_spline", 1e-3, true, true, true)};
}

template <class Real>
struct Triple {
  Real at[3] = {};
};

// A body in a RealRule's units.
template <class Real>
struct Small {
  explicit Small(const Case& c) : tables(c.rule), rule(tables.rule()), type(c.body.type) {
    for (size_t i = 0; i < c.body.size(); ++i) {
      x.push_back(taken(c.body.x[i], tables.length));
      v.push_back(taken(c.body.v[i], tables.velocity));
      u.push_back(c.body.u.empty() ? Triple<Real>{} : taken(c.body.u[i], tables.length));
    }
    extent = taken(c.box.extent, tables.length);
  }
  static Triple<Real> taken(const Vec3& from, double unit) {
    Triple<Real> to;
    for (int a = 0; a < 3; ++a) to.at[a] = static_cast<Real>(from[a] / unit);
    return to;
  }
  static Vec3 given(const Triple<Real>& from, double unit) {
    return Vec3(static_cast<double>(from.at[0]), static_cast<double>(from.at[1]),
                static_cast<double>(from.at[2])) *
           unit;
  }
  Triple<Real> difference(size_t i, size_t j) const {
    Triple<Real> d;
    for (int a = 0; a < 3; ++a) {
      d.at[a] = x[j].at[a] - x[i].at[a];
      if (extent.at[a] > 0) d.at[a] -= extent.at[a] * std::round(d.at[a] / extent.at[a]);
    }
    return d;
  }
  std::vector<Triple<Real>> kicks() const {
    std::vector<Triple<Real>> sums(x.size());
    with_kinds(rule, [&]<LawKind kKind, bool kDamped, bool kScaled>() {
      for (size_t i = 0; i < x.size(); ++i) {
        for (size_t j = 0; j < x.size(); ++j) {
          if (i == j) continue;
          const Triple<Real> d = difference(i, j);
          Triple<Real> w;
          for (int a = 0; a < 3; ++a) w.at[a] = v[j].at[a] - v[i].at[a];
          add_pair_kick<kKind, kDamped, kScaled>(rule, rule.cache, d.at, w.at, type[i], type[j], sums[i].at);
        }
      }
    });
    return sums;
  }
  void step() {
    const std::vector<Triple<Real>> sums = kicks();
    for (size_t i = 0; i < x.size(); ++i)
      finish(rule, sums[i].at, x[i].at, v[i].at, rule.pd ? u[i].at : nullptr, type[i]);
  }

  RealTables<Real> tables;
  RealRule<Real> rule;
  std::vector<uint8_t> type;
  std::vector<Triple<Real>> x, v, u;
  Triple<Real> extent;
};

constexpr int kSteps = 50;

// Largest differences from the reference: of x, u in cutoffs; of v in cutoffs per step.
template <class Real>
void compare(const Case& c, double tolerance) {
  Reference reference(c.rule, c.body, c.box);
  Small<Real> small(c);
  reference.step(kSteps);
  for (int s = 0; s < kSteps; ++s) small.step();
  const Body& body = reference.body();
  double x = 0, v = 0, u = 0, moved = 0;
  for (size_t i = 0; i < body.size(); ++i) {
    const double length = small.tables.length, velocity = small.tables.velocity;
    x = std::max(x, (body.x[i] - small.given(small.x[i], length)).cwiseAbs().maxCoeff() / length);
    v = std::max(v, (body.v[i] - small.given(small.v[i], velocity)).cwiseAbs().maxCoeff() / velocity);
    if (!body.u.empty())
      u = std::max(u, (body.u[i] - small.given(small.u[i], length)).cwiseAbs().maxCoeff() / length);
    moved = std::max(moved, (body.x[i] - c.body.x[i]).norm() / length);
  }
  std::printf("  %-32s x %.1e  v %.1e  u %.1e  moved %.2f\n", c.name.c_str(), x, v, u, moved);
  EXPECT_GT(moved, 0.05) << c.name << ": nothing happens";
  EXPECT_LE(x, tolerance) << c.name;
  EXPECT_LE(v, tolerance / 10) << c.name;
  EXPECT_LE(u, tolerance) << c.name;
}

// A step rounds x, of less than 4 cutoffs, by 2^-23 in floats: 4u with u = 2^-24; 50 steps, all to one side,
// make 200u. Springs turn errors of x into errors of v; over these few periods neither grows nor dies away,
// and errors of x that v brings are of the order of those that brought it. So 200u, for as a rule roundings
// are not all to one side; of v, a tenth, as a vibration's v per step is a tenth of its x or less. In doubles
// the reference rounds too, in metres: twice that.
TEST(RealSteps, FollowTheReferenceInFloats) {
  for (const Case& c : cases()) compare<float>(c, 200 * 0x1p-24);
}
TEST(RealSteps, FollowTheReferenceInDoubles) {
  for (const Case& c : cases()) compare<double>(c, 400 * 0x1p-53);
}

// Of all particles and pairs, against the formulas of model/analysis/measure.h and Reference's own sum.
TEST(RealEnergies, AreThoseOfTheReference) {
  for (const Case& c : cases()) {
    Reference reference(c.rule, c.body, c.box);
    reference.step(kSteps);
    const Body& body = reference.body();
    const std::vector<Vec3> forces = reference.forces();
    Energies expected;
    for (size_t i = 0; i < body.size(); ++i) {
      const Vec3 v = body.v[i] + c.rule.dt / 2 * acceleration(c.rule, body, i, forces[i]);
      expected.kinetic += c.rule.mass_of(body.type[i]) * v.squaredNorm() / 2;
      expected.gravity -= c.rule.mass_of(body.type[i]) * c.rule.types[body.type[i]].gravity.dot(body.x[i]);
    }
    expected.potential = reference.potential_energy();
    const Case now{c.name, c.rule, body, c.box};
    const EnergyTables tables(c.rule);
    const EnergyRule energy = tables.rule();
    const auto expect_energies = [&]<class Real>(double tolerance) {
      const Small<Real> small(now);
      const std::vector<Triple<Real>> sums = small.kicks();
      Energies got;
      double bonds = 0, heights = 0;
      for (size_t i = 0; i < small.x.size(); ++i) {
        const Triple<double> x = Small<double>::taken(body.x[i], small.tables.length);
        add_particle_energy(small.rule, energy, sums[i].at, x.at, small.v[i].at,
                            small.rule.pd ? small.u[i].at : nullptr, small.type[i], got.kinetic, got.gravity);
        for (int a = 0; a < 3; ++a) heights += std::abs(energy.weight[3 * small.type[i] + a] * x.at[a]);
        for (size_t j = 0; j < i; ++j) {
          const Triple<Real> d = small.difference(i, j);
          double s = 0;
          for (const Real along : d.at) s += static_cast<double>(along) * static_cast<double>(along);
          const double pair = pair_energy(energy, s, small.type[i], small.type[j]);
          got.potential += pair;
          bonds += std::abs(pair);
        }
      }
      EXPECT_NEAR(got.kinetic, expected.kinetic, tolerance * expected.kinetic) << c.name;
      EXPECT_NEAR(got.potential, expected.potential, tolerance * bonds) << c.name;
      EXPECT_NEAR(got.gravity, expected.gravity, 1e-14 * heights) << c.name;
    };
    // x is rounded to 4u, a bond of 0.4 cutoffs to 10u, its energy to some 20 times that: its steepest side
    // is a power 12. Speeds, small beside the forces on them, as forces are.
    expect_energies.operator()<double>(200 * 0x1p-53 + 1e-12);
    expect_energies.operator()<float>(200 * 0x1p-24);
  }
}

// U - table <= h^2/16 max |U'' - l| for any linear l: without the cubic whose second derivative l is, which
// the table has exactly, what is left has a second derivative R'' of |U'' - l| at most, and the error in the
// middle, where it is largest, is the integral of R'' times Peano's kernel, h^2/8 (1 - 4 t/h) for t < h/2 and
// its mirror image, whose absolute value integrates to h^2/16. U'' = (f/r - f')/(4 r^2) by s = r^2. Rounding:
// 16 u of the largest energy around (of a whole piece, whose integral the law takes: at most the core's) and
// of the well's depth, most of them the law's own; and, of r by a root and a product for the table and again
// here, 8 u of f r.
TEST(EnergyTable, IsWithinItsBound) {
  for (const test::NamedRule& named : test::made_rules()) {
    const PairLaw& law = *named.rule.law;
    const EnergyTables tables(named.rule);
    const EnergyRule energy = tables.rule();
    const double cutoff = law.cutoff(), core = law.core() / cutoff, core2 = core * core;
    const auto second = [&](double s) {
      const double r = std::min(std::sqrt(s), 1 - 1e-15) * cutoff;
      return cutoff * cutoff * cutoff * cutoff * (law.force(r) / r - law.slope(r)) / (4 * r * r);
    };
    const bool pieces = !std::holds_alternative<LennardJonesForm>(law.form());
    double deepest = 0;
    for (double r = core; r < 1; r += 1e-3) deepest = std::min(deepest, law.energy(r * cutoff));
    double worst = 0, worst_of_bound = 0;
    size_t bins = 0;
    for (double a = core2; a < 1; ++bins) {
      const int bits = bin_bits(a, kEnergyShift);
      const double b = std::bit_cast<double>(static_cast<uint64_t>(static_cast<uint32_t>(bits + 1))
                                             << (32 + kEnergyShift));
      const double h = b - a, low = second(std::nextafter(a, 2.0)), high = second(std::nextafter(b, 0.0));
      double off = 0, energy_around = 0, work = 0;
      for (int k = 1; k < 8; ++k) {
        const double t = k / 8.0;
        off = std::max(off, std::abs(second(a + t * h) - (low + t * (high - low))));
        const double r = std::sqrt(a + t * h) * cutoff;
        energy_around = std::max(energy_around, std::abs(law.energy(r)));
        work = std::max(work, std::abs(law.force(r) * r));
      }
      if (pieces) energy_around = law.energy(law.core());
      const double round = 0x1p-49 * (energy_around + std::abs(deepest)) + 0x1p-50 * work;
      const double bound = h * h / 16 * off + round;
      for (const double t : {0.0, 0.2, 0.5, 0.7}) {
        const double s = a + t * h, expected = law.energy(std::sqrt(s) * cutoff);
        const double error = std::abs(pair_energy(energy, s, 0, 0) - expected);
        ASSERT_LE(error, bound) << named.name << " at s " << s;
        if (bound > 2 * round) worst_of_bound = std::max(worst_of_bound, error / bound);
        worst = std::max(worst, error / std::max(std::abs(expected), std::abs(deepest)));
      }
      a = b;
    }
    for (const double s : {0.0, 0.1 * core2, 0.9 * core2, std::nextafter(core2, 0.0)}) {
      const double expected = law.energy(std::sqrt(s) * cutoff);
      EXPECT_NEAR(pair_energy(energy, s, 0, 0), expected, 1e-14 * std::abs(expected)) << named.name;
      EXPECT_NEAR(pair_energy(energy, s, 1, 0), named.rule.pair_energy(1, 0, std::sqrt(s) * cutoff),
                  1e-14 * std::abs(expected))
          << named.name;
    }
    if (named.rule.only_touch(1, 0)) {
      const double touch = named.rule.contact_distance / cutoff;
      EXPECT_GT(pair_energy(energy, 0.99 * touch * touch, 1, 0), 0);
      for (const double s : {touch * touch, 0.5 + 0.5 * touch * touch})
        EXPECT_EQ(pair_energy(energy, s, 1, 0), 0) << s;
    }
    for (const double s : {1.0, 1.5, std::numeric_limits<double>::infinity()})
      EXPECT_EQ(pair_energy(energy, s, 0, 0), 0) << named.name;
    EXPECT_GT(bins, size_t{kEnergyBins});
    std::printf("  %-18s %6zu bins  error/bound %.2f  relative %.1e\n", named.name.c_str(), bins,
                worst_of_bound, worst);
  }
}

// Beside the rule in doubles: the bins' error is 1e-7 of the deepest well at most (the table above), and
// 1e-12 of the energy is rounding.
TEST(EnergyTable, HasEachPairsLaw) {
  const Rule rule = test::several_laws().rule;
  const EnergyTables tables(rule);
  const EnergyRule energy = tables.rule();
  const double cutoff = rule.cutoff();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const PairLaw& law = rule.law_of(i, j);
      const double well = std::abs(law.energy(1e-3));
      ASSERT_GT(well, 0);
      for (int k = 0; k <= 5000; ++k) {
        const double r = 1.05 * cutoff * k / 5000, expected = rule.pair_energy(i, j, r);
        const double got = pair_energy(energy, r * r / (cutoff * cutoff), i, j);
        ASSERT_NEAR(got, expected, 1e-6 * well + 1e-12 * std::abs(expected)) << i << " " << j << " at " << r;
      }
      EXPECT_EQ(pair_energy(energy, std::pow(law.cutoff() / cutoff, 2), i, j), 0);
    }
}

}  // namespace
}  // namespace cuboct::gpu
