// SPDX-License-Identifier: MIT
// The atoms of one macro-element: a periodic sample of its crystal, strained as the element is, at rest.
// A. A. Zhuravlev, K. K. Abgaryan, D. L. Reviznikov, Symmetry 13 (2021) 219: equations 7 to 9. Here, and in
// what it asks of a potential, energies are in eV and lengths in angstrom; stresses come out in Pa.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "model/base/mat3.h"

namespace cuboct {

inline constexpr double kPascal = 160.21766208e9;  // Pa, of an eV/angstrom^3 (CODATA 2014)

// Evaluates samples one after the other, each of as many atoms as the one before: it may keep lists. Each
// thread has its own.
class AtomicForces {
 public:
  virtual ~AtomicForces() = default;
  // Energy (eV) of atoms at `x` (angstrom) that repeat with the columns of `cell` (angstrom); fills `f`
  // (eV/angstrom) and `virial`, the derivative of the energy with respect to a strain of cell and atoms (eV,
  // symmetric, positive where the sample pulls).
  virtual double evaluate(const Mat3& cell, std::span<const Vec3> x, std::span<Vec3> f, Mat3& virial) = 0;
};

// A potential with one kind of atom.
class AtomicLaw {
 public:
  virtual ~AtomicLaw() = default;
  virtual std::unique_ptr<AtomicForces> forces() const = 0;
};

// A sample without strain, in the axes of its lattice.
struct AtomicLattice {
  Mat3 cell = Mat3::Zero();  // angstrom, edges of the sample: columns
  std::vector<Vec3> place;   // fractions of the edges
  double mass = 0;           // kg, of an atom

  double density() const;  // kg/m^3
};

// Of diamond a cubic cell has 8 atoms, of FCC 4.
enum class Crystal : uint8_t { diamond, fcc };

// cells^3 cubic cells of edge `edge` (angstrom).
AtomicLattice crystal_lattice(Crystal crystal, double edge, int cells, double mass);

struct Relaxation {
  double force = 1e-6;   // eV/angstrom: no component of a force on an atom is larger at rest
  double stiffness = 0;  // eV/angstrom^2, of the stiffest vibration in which a sample gives way
  uint64_t most = 5000;  // force evaluations
};

// What a sample at rest says.
struct SampleAnswer {
  double energy = 0;           // eV
  Mat3 stress = Mat3::Zero();  // Pa, Cauchy's, tension positive
  uint64_t evaluations = 0;    // of forces
  bool at_rest = false;
  double force = 0;  // eV/angstrom, the largest component that is left
};

// Moves the atoms of `place` (fractions of `cell`'s columns) to rest within the cell, and leaves them there
// for the next cell. First by steps downhill whose length the last two forces tell (J. Barzilai and J.
// Borwein, IMA J. Numer. Anal. 8, 141 (1988)), which near rest needs few; where these do not come to rest
// soon, by model/base/fire.h.
SampleAnswer relax_sample(AtomicForces& forces, const Mat3& cell, std::vector<Vec3>& place,
                          const Relaxation& how);

// The same without moving an atom.
SampleAnswer held_sample(AtomicForces& forces, const Mat3& cell, const std::vector<Vec3>& place);

}  // namespace cuboct
