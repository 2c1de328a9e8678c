// SPDX-License-Identifier: MIT
// Energy, forces and virial of atoms under Tersoff's potential, in doubles. One object serves a sheet of a
// million atoms on all threads, or, one per thread, thousands of small samples in turn: its memory grows to
// the largest and stays.
//
//   BondList list(tersoff.cutoff(), skin, bond_lanes());   // one per sample
//   TersoffForces forces(tersoff);                         // one per thread
//   list.update(box, x);
//   forces.evaluate(list, box, x, f, {.sums = true});
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "model/atoms/bond_order/bond_list.h"
#include "model/atoms/bond_order/tersoff_kernel.h"
#include "model/atoms/bond_order/tersoff_parameters.h"
#include "model/base/mat3.h"

namespace cuboct {

struct TersoffAsked {
  bool sums = false;  // energy and virial too
  int threads = 1;    // leave no mark in the bits
  std::span<const uint8_t> element =
      {};  // of each atom, index into Tersoff::elements; empty: all are the first
};

class TersoffForces {
 public:
  explicit TersoffForces(Tersoff tersoff);

  // Fills f, of the size of x, with the forces in (unit of A)/(unit of R). `list` must hold at x.
  // std::invalid_argument where the list is of other lanes or atoms, or an element is not there.
  void evaluate(const BondList& list, const AtomBox& box, std::span<const Vec3> x, std::span<Vec3> f,
                const TersoffAsked& asked = {});

  // The same in parts, for who runs the sweeps: begin() with what is asked, the first sweep over all groups,
  // then the second, each group once and by any thread, then the sums. `list` and the lists of `asked` must
  // stay until then.
  void begin(const BondList& list, const AtomBox& box, std::span<const Vec3> x, const TersoffAsked& asked);
  void first_sweep(size_t first, size_t last);
  void second_sweep(size_t first, size_t last, std::span<Vec3> f);
  // Energy and virial of the positions of the last begin(), whatever it asked.
  void sum_up(int threads);
  // Pairs of the last begin() that are within the cutoff, each once.
  uint64_t bonds() const;

  // Of the last evaluation with sums. Summed by ascending atom.
  double energy() const { return energy_; }
  // dE/dstrain = sum_ij d_ij (x) G_ij, symmetric; over the box's volume the stress, tension positive.
  const Mat3& virial() const { return virial_; }
  // An atom's share, half of all V_ij of its own bonds: sum_i E_i = E. Other codes share V_ij among both
  // atoms.
  double energy_of(size_t atom) const { return energies_[atom]; }
  Mat3 virial_of(size_t atom) const;

  const Tersoff& tersoff() const { return tersoff_; }

 private:
  void place(const BondList& list, const AtomBox& box, std::span<const Vec3> x, const TersoffAsked& asked);
  void add_up();
  TersoffSweep sweep();

  Tersoff tersoff_;
  const BondList* list_ = nullptr;  // of the last begin()
  bool sums_ = false;
  size_t lanes_ = 1;
  double energy_ = 0;
  Mat3 virial_ = Mat3::Zero();
  std::vector<double> x_;
  std::vector<double> partial_, force_, energies_, virials_;
};

}  // namespace cuboct
