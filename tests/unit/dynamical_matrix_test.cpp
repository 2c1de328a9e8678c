// SPDX-License-Identifier: MIT
#include "model/solid/dynamical_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "model/base/error.h"
#include "model/contract/law.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

using std::numbers::pi;
using std::numbers::sqrt2;

TEST(FccNeighbours, HaveTheShellsOfTheTextbook) {
  // Shells at pitch * sqrt(n): 12, 6, 24, 12, 24, 8, 48, 6 ...
  const int shells[] = {12, 6, 24, 12, 24, 8, 48, 6};
  size_t sum = 0;
  for (int n = 1; n <= 8; ++n) {
    sum += shells[n - 1];
    EXPECT_EQ(fcc_neighbours(0.7, 0.7 * std::sqrt(n + 0.5)).size(), sum) << n;
  }
  EXPECT_TRUE(fcc_neighbours(1, 0.99).empty());
}

// A ball of 25 pitches holds 4 pi/3 sqrt(2) 25^3 = 92,561 particles, one of 26 holds 104,117.
TEST(FccNeighbours, AreABoundedNumber) {
  EXPECT_NEAR(static_cast<double>(fcc_neighbours(0.1, 2.5).size()), 92561, 300);  // its surface is rough
  EXPECT_NO_THROW(check_neighbours(0.1, 2.5));
  EXPECT_THROW(check_neighbours(0.1, 2.6), InputError);
  EXPECT_THROW(fcc_neighbours(1e-9, 1), InputError);
}

// Nearest neighbours joined by springs k at rest. At X = (2 pi/a)(1,0,0) the 8 neighbours with a component
// along x move against the particle, each resisting with 2 k e_x^2 = k: m w^2 = 8 k along x, and 4 k across
// (its 4 neighbours in either plane). At L the 6 neighbours off the plane do, each with 2 k (2/3): again 8 k.
TEST(Phonons, OfNearestNeighbourSpringsAtXAndL) {
  const double pitch = 3e-4, k = 2e4, mass = 5e-9, edge = sqrt2 * pitch;
  const auto law = preset_law("elastic", pitch, k);
  const Vec3 x = squared_frequencies(*law, mass, pitch, 2 * pi / edge * Vec3(1, 0, 0));
  EXPECT_NEAR(x[2] * mass / k, 8, 1e-12);
  EXPECT_NEAR(x[1] * mass / k, 4, 1e-12);
  EXPECT_NEAR(x[0] * mass / k, 4, 1e-12);
  const Vec3 l = squared_frequencies(*law, mass, pitch, pi / edge * Vec3(1, 1, 1));
  EXPECT_NEAR(l[2] * mass / k, 8, 1e-12);
  EXPECT_NEAR(l[0] * mass / k, 2, 1e-12);
  EXPECT_NEAR(squared_frequencies(*law, mass, pitch, Vec3::Zero()).norm(), 0, 1e-9);
  EXPECT_NEAR(largest_frequency(*law, mass, pitch), std::sqrt(8 * k / mass), 1e-12 * std::sqrt(8 * k / mass));
}

// Long waves are sound: m w^2/q^2 -> C/density for the elastic constant of the wave.
TEST(Phonons, ShortWaveVectorsAreSound) {
  const auto law = lennard_jones(1, 1, 2.6, 0.8);
  const double pitch = relaxed_pitch(*law, 1.1), q = 1e-3;
  const Matrix6 c = elastic_constants(*law, pitch);
  const double volume = fcc_volume(pitch);
  const Vec3 x = squared_frequencies(*law, 1, pitch, Vec3(q, 0, 0)) / (q * q);
  EXPECT_NEAR(x[2], c(0, 0) * volume, 1e-5 * x[2]);
  EXPECT_NEAR(x[0], c(3, 3) * volume, 1e-5 * x[2]);
  const Vec3 xy = squared_frequencies(*law, 1, pitch, Vec3(q, q, 0)) / (2 * q * q);
  EXPECT_NEAR(xy[2], (c(0, 0) + c(0, 1) + 2 * c(3, 3)) / 2 * volume, 1e-5 * x[2]);
}

TEST(Phonons, ThePresetsAreStableEverywhere) {
  int checked = 0;
  for (const char* name : {"elastic", "brittle", "ductile", "viscous"}) {
    const auto law = preset_law(name, 1, 1);
    for (int i = 0; i < 8; ++i) {
      for (int j = 0; j <= i; ++j) {
        for (int k = 0; k <= j; ++k, ++checked) {
          const Vec3 q = 2 * pi / sqrt2 / 7 * Vec3(i, j, k);
          EXPECT_GE(squared_frequencies(*law, 1, 1, q)[0], -1e-12) << name << " at " << q;
          EXPECT_LE(squared_frequencies(*law, 1, 1, q)[2], 8 + 1e-12) << name << " at " << q;
        }
      }
    }
  }
  EXPECT_EQ(checked, 4 * 120);
}

// A finer, blind scan finds nothing above the answer, and the answer is reached somewhere: with second
// neighbours the maximum is not a symmetry point's alone.
TEST(Phonons, LargestFrequencyBeatsABlindScan) {
  const auto law = lennard_jones(1, 1, 3.1, 0.8);
  for (const double pitch : {1.02, 1.0957, 1.15}) {
    const double answer = largest_frequency(*law, 1, pitch);
    double scan = 0;
    for (int i = -20; i <= 20; ++i) {
      for (int j = -20; j <= 20; ++j) {
        for (int k = 0; k <= 20; ++k) {
          const Vec3 q = 2 * pi / (sqrt2 * pitch) / 20 * Vec3(i, j, k);
          scan = std::max(scan, squared_frequencies(*law, 1, pitch, q)[2]);
        }
      }
    }
    EXPECT_LE(std::sqrt(scan), answer * (1 + 1e-12)) << pitch;
    EXPECT_GE(std::sqrt(scan), answer * 0.998) << pitch;
  }
}

// Of a law over thousands of neighbours: nothing of a scan is above, and a loose tolerance finds nearly it.
TEST(Phonons, LargestFrequencyOfALongLaw) {
  const auto law = spline_law({0, 0.2, 0.6, 1}, {2, 1.5, 0.7, 0}, Interpolation::monotone_cubic, 0.2);
  const double answer = largest_frequency(*law, 1, 0.2), loose = largest_frequency(*law, 1, 0.2, 1e-6);
  EXPECT_LE(loose, answer * (1 + 1e-9));
  EXPECT_GE(loose, answer * 0.999);
  double scan = 0;
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j)
      for (int k = 0; k < 9; ++k) {
        const Vec3 q = 2 * pi / (sqrt2 * 0.2) / 9 * Vec3(i + j, j + k, k + i);
        scan = std::max(scan, squared_frequencies(*law, 1, 0.2, q)[2]);
      }
  EXPECT_LE(std::sqrt(scan), loose);
  EXPECT_GE(std::sqrt(scan), answer * 0.95);
}

TEST(Phonons, LargestFrequencyIsZeroWhereNothingIsRestored) {
  const auto push = spline_law({1, 2, 3}, {-1, 1, 0}, Interpolation::monotone_cubic, 1);
  EXPECT_EQ(largest_frequency(*push, 1, 4), 0);  // no neighbour inside the cutoff
}

// Neighbours that resist nothing: a displacement along a bond grows, first where they push, too, so that each
// wave does; then from rest, where whole planes of waves are alike and a search could wander on them.
TEST(Phonons, LargestFrequencyIsZeroWhereNoWaveComesBack) {
  const auto growing = spline_law({0.5, 1, 1.1, 1.2}, {0.5, 1, 2, 0}, Interpolation::monotone_cubic, 0.5);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 q = 2 * pi / sqrt2 * Vec3::Unit(axis);
    ASSERT_LT(squared_frequencies(*growing, 1, 1, q)[2], 0);
  }
  EXPECT_EQ(largest_frequency(*growing, 1, 1), 0);
  const auto resting = spline_law({0.5, 1, 1.1, 1.2}, {-1, 0, 1, 0}, Interpolation::monotone_cubic, 0.5);
  ASSERT_GT(resting->slope(1), 0);
  EXPECT_NEAR(largest_frequency(*resting, 1, 1), 0, 1e-6);
}

// Springs k at rest: C11 = sqrt(2) k/pitch, C12 = C44 = C11/2 (12 bonds along <110>, each 1/(2 V) k pitch^2
// e_i e_j e_k e_l: 8 have e_x^4 = 1/4, 4 have e_x^2 e_y^2 = 1/4).
TEST(ElasticConstants, OfNearestNeighbourSprings) {
  const double pitch = 1e-4, k = 3e4;
  for (const char* name : {"elastic", "brittle", "ductile", "viscous"}) {
    const Matrix6 c = elastic_constants(*preset_law(name, pitch, k), pitch);
    const double c11 = sqrt2 * k / pitch;
    for (int a = 0; a < 6; ++a) {
      for (int b = 0; b < 6; ++b) {
        const double expected = a == b ? (a < 3 ? c11 : c11 / 2) : (a < 3 && b < 3 ? c11 / 2 : 0);
        EXPECT_NEAR(c(a, b), expected, 1e-12 * c11) << name << ' ' << a << b;
      }
    }
    // s11 = (C11+C12)/((C11-C12)(C11+2C12)) and 1/E111 = (s11 + 2 s12 + s44)/3 give E100 = (2/3) C11, E111
    // = 1.2 C11; along <110>, 1/E = (2 s11 + 2 s12 + s44)/4.
    EXPECT_NEAR(youngs_modulus(c, {1, 0, 0}), 2.0 / 3 * c11, 1e-12 * c11);
    EXPECT_NEAR(youngs_modulus(c, {-3, 3, 3}), 1.2 * c11, 1e-12 * c11);
    EXPECT_NEAR(youngs_modulus(c, {0, 2, 2}), c11, 1e-12 * c11);
  }
}

// Under pressure, too, the constants are the derivative of the stress: bulk modulus from the slope of the
// pressure, and C11 - C12 = 2 C44 - ... has no such shortcut, so a stretched lattice is summed by hand.
TEST(ElasticConstants, AreStressStrainCoefficientsUnderPressure) {
  const auto law = lennard_jones(1, 1, 2.6, 0.8);
  for (const double pitch : {1.05, 1.0957, 1.13}) {
    const Matrix6 c = elastic_constants(*law, pitch);
    const double h = 1e-6;
    const double bulk = -pitch / 3 *
                        (fcc_pressure(*law, pitch * (1 + h)) - fcc_pressure(*law, pitch * (1 - h))) /
                        (2 * h * pitch);
    EXPECT_NEAR((c(0, 0) + 2 * c(0, 1)) / 3, bulk, 1e-6 * std::abs(bulk)) << pitch;
    // Cauchy stress of the lattice deformed by F: -(1/2V det F) sum f r e e^T.
    const auto stress = [&](const Mat3& deformation) {
      Mat3 sum = Mat3::Zero();
      for (const Vec3& d0 : fcc_neighbours(pitch, 3)) {
        const Vec3 d = deformation * d0;
        sum -= law->force(d.norm()) / d.norm() * d * d.transpose();
      }
      return Mat3(sum / (2 * fcc_volume(pitch) * deformation.determinant()));
    };
    Mat3 stretch = Mat3::Zero(), shear = Mat3::Zero();
    stretch(0, 0) = h;
    shear(0, 1) = shear(1, 0) = h / 2;
    const Mat3 one = Mat3::Identity();
    const Mat3 by_stretch = (stress(one + stretch) - stress(one - stretch)) / (2 * h);
    const Mat3 by_shear = (stress(one + shear) - stress(one - shear)) / (2 * h);
    EXPECT_NEAR(c(0, 0), by_stretch(0, 0), 1e-6 * c(0, 0)) << pitch;
    EXPECT_NEAR(c(1, 0), by_stretch(1, 1), 1e-6 * c(0, 0)) << pitch;
    EXPECT_NEAR(c(5, 5), by_shear(0, 1), 1e-6 * c(0, 0)) << pitch;
  }
}

// Lattice sums for Lennard-Jones without cutoff, A6 = 14.45392104 and A12 = 12.13188020 (N. Bernardes, Phys.
// Rev. 112 (1958) 1534; J. E. Jones and A. E. Ingham, Proc. R. Soc. A 107 (1925) 636): r0^6 = 2 A12/A6, E =
// -A6^2/(2 A12), and the elastic constants at r0. What a cutoff rc leaves out falls as rc^-3; at 40 it is
// below 3e-5 of each number.
TEST(LatticeSums, OfLennardJonesWithoutCutoff) {
  const auto law = lennard_jones(1, 1, 40, 0.8);
  const double r0 = relaxed_pitch(*law, 1.1);
  EXPECT_NEAR(r0, 1.090173, 3e-6);
  EXPECT_NEAR(r0, std::pow(2 * 12.13188020 / 14.45392104, 1.0 / 6), 3e-6);
  EXPECT_NEAR(fcc_energy(*law, r0), -8.610200, 6e-4);  // the shift of the truncation adds as much as the tail
  const Matrix6 c = elastic_constants(*law, r0);
  EXPECT_NEAR(c(0, 0), 105.182, 3e-3);
  EXPECT_NEAR(c(0, 1), 60.187, 2e-3);
  EXPECT_NEAR(c(3, 3), 60.187, 2e-3);
}

// The same with plain truncation at 2.5 sigma, from LAMMPS 29 Sep 2021 (Debian 12).
TEST(LatticeSums, OfLennardJonesTruncated) {
  const auto law = lennard_jones(1, 1, 2.5, 0.8);
  const double pitch = relaxed_pitch(*law, 1.1);
  EXPECT_NEAR(sqrt2 * pitch, 1.549603, 1e-6);
  EXPECT_NEAR(fcc_pressure(*law, pitch), 0, 1e-12);
  // Unshifted, as LAMMPS counts: each pair inside the cutoff (12+6+24+12+24 = 78 neighbours) has the shift
  // more.
  const double shift = 4 * (std::pow(2.5, -12) - std::pow(2.5, -6));
  EXPECT_NEAR(fcc_energy(*law, pitch) + 39 * shift, -8.099621, 1e-6);
  const Matrix6 c = elastic_constants(*law, pitch);
  EXPECT_NEAR(c(0, 0), 97.71, 5e-3);
  EXPECT_NEAR(c(0, 1), 55.63, 5e-3);
  EXPECT_NEAR(c(3, 3), 55.63, 5e-3);
}

TEST(RelaxedPitch, FindsThePitchOfAPresetAndRefusesWhereThereIsNone) {
  const auto law = preset_law("ductile", 1e-4, 3e4);
  EXPECT_NEAR(relaxed_pitch(*law, 1e-4), 1e-4, 1e-19);
  EXPECT_NEAR(relaxed_pitch(*law, 0.93e-4), 1e-4, 1e-19);
  EXPECT_NEAR(relaxed_pitch(*law, 1.07e-4), 1e-4, 1e-19);
  const auto push = spline_law({1, 2}, {1, 0}, Interpolation::monotone_cubic, 1);
  EXPECT_EQ(refused_with([&] { relaxed_pitch(*push, 1.5); }),
            "the packing has no pitch of zero pressure between 0.75 m and 3 m");
}

}  // namespace
}  // namespace cuboct
