// SPDX-License-Identifier: MIT
// The reference engine against LAMMPS: forces, virial stress, energies and trajectories of the same shaken
// FCC block. Reduced units, epsilon = sigma = mass = 1.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "model/contract/law.h"
#include "model/real/reference.h"
#include "model/solid/dynamical_matrix.h"
#include "tests/fcc_block.h"
#include "tests/peer/lammps.h"

namespace cuboct {
namespace {

constexpr int kCells = 4;
constexpr int kSteps = 200;
constexpr double kDt = 0.005;

// Box shapes: which axes are periodic.
struct Space {
  const char* name;
  std::array<bool, 3> ring;
};
const Space kSpaces[] = {
    {"periodic", {true, true, true}}, {"open", {false, false, false}}, {"slab", {true, true, false}}};

void PrintTo(const Space& space, std::ostream* out) { *out << space.name; }

struct System {
  Body body;
  Periodic box;
};
System shaken_block(const Space& space, double pitch) {
  System system{test::fcc_block(kCells, pitch), test::fcc_box(kCells, pitch)};
  // Half a step inside the box, so that no particle starts on its border.
  for (Vec3& x : system.body.x) x += Vec3::Constant(0.25 * pitch);
  test::shake(system.body, 0.05 * pitch, 0.8, 11);
  for (int axis = 0; axis < 3; ++axis) {
    if (!space.ring[axis]) system.box.extent[axis] = 0;
  }
  return system;
}

// The largest difference of two lists over the largest entry of the second.
template <class T>
double difference(const std::vector<T>& a, const std::vector<T>& b) {
  double worst = 0, scale = 0;
  EXPECT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, (a[i] - b[i]).cwiseAbs().maxCoeff());
    scale = std::max(scale, b[i].cwiseAbs().maxCoeff());
  }
  return worst / scale;
}

// Relative differences from LAMMPS; those of positions are in pitches.
struct Differences {
  double force, virial, energy;          // at the start
  double x, v, last_force, last_energy;  // after kSteps
};
Differences compare(const std::shared_ptr<const PairLaw>& law, const System& system, double pitch,
                    const std::vector<test::LammpsFrame>& peer) {
  Reference run(test::simple_rule(law, 1, kDt), system.body, system.box, Integrator::velocity_verlet);
  Differences d{};
  d.force = difference(run.forces(), peer[0].f);
  d.virial = difference(run.virial_stress(1), peer[0].virial);
  d.energy = std::abs(run.potential_energy() / peer[0].potential_energy - 1);
  run.step(kSteps);
  for (size_t i = 0; i < system.body.size(); ++i) {
    d.x = std::max(d.x, (run.body().x[i] - peer[1].x[i]).cwiseAbs().maxCoeff() / pitch);
  }
  d.v = difference(run.body().v, peer[1].v);
  d.last_force = difference(run.forces(), peer[1].f);
  d.last_energy = std::abs((run.potential_energy() + run.kinetic_energy()) /
                               (peer[1].potential_energy + peer[1].kinetic_energy) -
                           1);
  if (std::getenv("CUBOCT_VERBOSE")) {
    fmt::print(
        "force {:.2e} virial {:.2e} energy {:.2e} x {:.2e} v {:.2e} last force {:.2e} last energy {:.2e}\n",
        d.force, d.virial, d.energy, d.x, d.v, d.last_force, d.last_energy);
  }
  return d;
}

class Lammps : public testing::TestWithParam<Space> {
 protected:
  void SetUp() override {
    if (!test::have_lammps()) GTEST_SKIP() << "LAMMPS (lmp) was not found when the build was configured";
  }
  std::vector<test::LammpsFrame> run(const System& system, const std::string& pair,
                                     std::vector<std::pair<std::string, std::string>> files = {}) {
    return test::run_lammps({system.box, pair, 1, kDt, kSteps, std::move(files)}, system.body);
  }
};
INSTANTIATE_TEST_SUITE_P(Spaces, Lammps, testing::ValuesIn(kSpaces),
                         [](const auto& info) { return info.param.name; });

// Both programs evaluate the same formula in doubles; only the order of operations and sums differs. 200
// steps are one unit of time, in which the block's chaos lets rounding grow by a few units of e.
constexpr double kForceTolerance = 1e-10, kTrajectoryTolerance = 1e-8;

void expect_rounding_alone(const Differences& d) {
  EXPECT_LT(d.virial, kForceTolerance);
  EXPECT_LT(d.energy, kForceTolerance);
  EXPECT_LT(d.x, kTrajectoryTolerance);
  EXPECT_LT(d.v, kTrajectoryTolerance);
  EXPECT_LT(d.last_force, kTrajectoryTolerance);
  EXPECT_LT(d.last_energy, kTrajectoryTolerance);
}

TEST_P(Lammps, LennardJonesAgreesToRounding) {
  const double cutoff = 2.5;
  const auto law = lennard_jones(1, 1, cutoff, 0.5);
  const double pitch = relaxed_pitch(*law, 1.1);
  const System system = shaken_block(GetParam(), pitch);
  // shift: the energy, not the force, is 0 at the cutoff, as ours is.
  const auto peer =
      run(system, fmt::format("pair_style lj/cut {0}\npair_coeff 1 1 1 1\npair_modify shift yes", cutoff));
  const Differences d = compare(law, system, pitch, peer);
  EXPECT_LT(d.force, kForceTolerance);
  expect_rounding_alone(d);
  // The block has moved: the comparison saw dynamics.
  double moved = 0;
  for (size_t i = 0; i < system.body.size(); ++i)
    moved = std::max(moved, (peer[1].x[i] - system.body.x[i]).norm());
  EXPECT_GT(moved, 0.1);

  // A millionth of sigma turns every comparison red.
  const Differences wrong = compare(lennard_jones(1, 1 + 1e-6, cutoff, 0.5), system, pitch, peer);
  EXPECT_GT(wrong.force, 1e4 * kForceTolerance);
  EXPECT_GT(wrong.virial, 1e4 * kForceTolerance);
  EXPECT_GT(wrong.energy, 1e3 * kForceTolerance);
  EXPECT_GT(wrong.x, 10 * kTrajectoryTolerance);
  EXPECT_GT(wrong.v, 10 * kTrajectoryTolerance);
  EXPECT_GT(wrong.last_force, 10 * kTrajectoryTolerance);
}

TEST_P(Lammps, SmoothedLennardJonesAgreesToRounding) {
  const double cutoff = 2.5;
  const auto law = lennard_jones(1, 1, cutoff, 0.5, Smoothing::linear);
  const double pitch = relaxed_pitch(*law, 1.1);
  const System system = shaken_block(GetParam(), pitch);
  const auto peer = run(system, fmt::format("pair_style lj/smooth/linear {0}\npair_coeff 1 1 1 1", cutoff));
  const Differences d = compare(law, system, pitch, peer);
  // A double's rounding of the largest of a few hundred terms.
  EXPECT_LT(d.force, 2e-14);
  expect_rounding_alone(d);

  const Differences wrong = compare(lennard_jones(1, 1, cutoff, 0.5), system, pitch, peer);
  EXPECT_GT(wrong.force, 1e-4);
  EXPECT_GT(wrong.energy, 1e-2);
  EXPECT_GT(wrong.x, 1e-4);
}

// A law of ours as LAMMPS's table. With `linear`, values at N equal steps h of r^2 that span exactly the
// table's range are taken as they stand (the style's "match"), and LAMMPS's force is the linear interpolant
// in r^2 of g = f/r. It differs from ours by at most h^2/8 max |d2g/d(r2)^2| in g.
struct Table {
  std::string text;
  double step;     // h
  double error_g;  // the bound
};
constexpr int kEntries = 100001;
constexpr double kInner = 0.6;  // no pair of these runs comes nearer

Table table_of(const PairLaw& law) {
  const double low = kInner * kInner, high = law.cutoff() * law.cutoff();
  Table table{fmt::format("# r, energy and force\n\nLAW\nN {} RSQ {:.17g} {:.17g}\n\n", kEntries, kInner,
                          law.cutoff()),
              (high - low) / (kEntries - 1), 0};
  std::vector<double> g;
  for (int k = 0; k < kEntries; ++k) {
    const double r = k + 1 == kEntries ? law.cutoff() : std::sqrt(low + k * table.step);
    table.text += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", k + 1, r, law.energy(r), law.force(r));
    g.push_back(law.force(r) / r);
  }
  // The largest second difference is h^2 times the largest second derivative.
  for (size_t k = 1; k + 1 < g.size(); ++k) {
    table.error_g = std::max(table.error_g, std::abs(g[k - 1] - 2 * g[k] + g[k + 1]) / 8);
  }
  return table;
}

std::shared_ptr<const PairLaw> table_law(Interpolation interpolation, double stretch) {
  std::vector<double> r{0.5, 0.7, 0.9, 1.0, 1.1, 1.3, 1.42, 1.6, 1.8}, f{9, 8, 3.5, 0, -2.5, -2, 0.4, 0.2, 0};
  for (double& x : r) x *= stretch;
  return spline_law(r, f, interpolation, 0.55);
}

TEST_P(Lammps, SplinesAgreeWithinTheTablesInterpolation) {
  for (const Interpolation interpolation : {Interpolation::monotone_cubic, Interpolation::b_spline}) {
    const auto law = table_law(interpolation, 1);
    const double pitch = 1;
    const System system = shaken_block(GetParam(), pitch);
    const Table table = table_of(*law);
    const auto peer = run(system,
                          fmt::format("pair_style table linear {}\npair_coeff 1 1 law.table LAW {:.17g}",
                                      kEntries, law->cutoff()),
                          {{"law.table", table.text}});
    // Per particle at most 18 neighbours (two shells) act; each is off by error_g * r, r below the cutoff.
    double scale = 0;
    for (const Vec3& f : peer[0].f) scale = std::max(scale, f.cwiseAbs().maxCoeff());
    const double force_tolerance = 18 * table.error_g * law->cutoff() / scale;
    EXPECT_LT(force_tolerance, 1e-7);
    // A force error F acts for t = 1: F t^2/2 in place and F t in speed (mass 1), and grows with the block's
    // chaos, for which e^2 is allowed.
    const double t = kSteps * kDt, growth = std::exp(2.0);
    const double x_tolerance = force_tolerance * scale * t * t / 2 * growth / pitch;
    const double v_tolerance = force_tolerance * scale * t * growth / 0.5;  // the fastest is above 0.5
    const Differences d = compare(law, system, pitch, peer);
    EXPECT_LT(d.force, force_tolerance);
    EXPECT_LT(d.virial,
              force_tolerance * 10);  // sums of f r, no cancellation in the error, some in the value
    EXPECT_LT(d.x, x_tolerance);
    EXPECT_LT(d.v, v_tolerance);

    const Differences wrong = compare(table_law(interpolation, 1 + 1e-6), system, pitch, peer);
    EXPECT_GT(wrong.force, 5 * force_tolerance);
    EXPECT_GT(wrong.x, x_tolerance);
    EXPECT_GT(wrong.v, v_tolerance);
    if (std::getenv("CUBOCT_VERBOSE"))
      fmt::print("tolerances {:.2e} {:.2e} {:.2e}\n", force_tolerance, x_tolerance, v_tolerance);
  }
}

}  // namespace
}  // namespace cuboct
