// SPDX-License-Identifier: MIT
// Many small periodic samples of one element under Tersoff's potential on a device, one block of threads and
// its shared memory each: molecular dynamics, or relaxation to rest. Energies in eV, lengths in angstrom,
// times in fs, masses in u. docs/reference/samples.md.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/base/vec.h"

namespace cuboct::gpu {

struct SampleOptions {
  bool doubles = false;
  double skin = 0.3;          // beyond the cutoff; bonds are listed anew when an atom has moved half of it
  double bonds_per_atom = 5;  // room for listed bonds at first; it grows where a sample needs more
  int device = 0;
};

struct SampleState {
  double energy = 0;
  std::array<double, 6> virial{};  // xx, yy, zz, yz, xz, xy of dE/dstrain, positive where a sample pulls
  double force = 0;                // the largest component of any atom's
  uint32_t evaluations = 0;        // of forces that relaxing took
};

// u angstrom^2/fs^2 in eV (CODATA 2018).
inline constexpr double kMassUnit = 103.642696;

class Samples {
 public:
  virtual ~Samples() = default;
  // All samples have as many atoms, repeat along three edges and begin without velocities. InputError, naming
  // the sample, where a cell is thinner than cutoff and skin or has no volume, or a sample does not fit into
  // a block's memory.
  virtual void set(std::span<const AtomCell> samples) = 0;
  // Each of these computes the forces of all samples at their end. std::runtime_error, naming the sample,
  // where a position is not finite any more.
  virtual void evaluate() = 0;
  virtual void advance(uint32_t steps, double dt, double mass) = 0;
  // Until no component of a force is above `tolerance` (eV/angstrom), or `most` evaluations were done.
  // `stiffness` (eV/angstrom^2): no curvature of the energy is much above it; it sets the step.
  virtual void relax(double tolerance, double stiffness, uint32_t most) = 0;

  virtual std::vector<SampleState> states() const = 0;
  // Of all atoms, sample by sample.
  virtual std::vector<Vec3> positions() const = 0;
  virtual std::vector<Vec3> velocities() const = 0;
  virtual std::vector<Vec3> forces() const = 0;
  virtual size_t block_bytes() const = 0;  // of shared memory that a sample takes
};

std::unique_ptr<Samples> make_samples(const TersoffTerm<double>& term, const SampleOptions& options = {});

}  // namespace cuboct::gpu
