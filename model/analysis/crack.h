// SPDX-License-Identifier: MIT
// The bonds of a region, and the crack that broken ones make.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "model/analysis/strain.h"
#include "model/scene/scene.h"

namespace cuboct {

// m, the distance beyond which a bond of two such particles is broken: the cutoff of their law. 0 where the
// two only touch: they have no bond.
double bond_reach(const Rule& rule, int type_i, int type_j);

class CrackMeter {
 public:
  // Bonds are the pairs of the probe's set that are nearer than probe.bond_length in `initial`, or in
  // probe.begin, and within their reach. The probe's ids are places in `initial`.
  CrackMeter(const Probe& probe, const Periodic& periodic, const std::vector<Vec3>& initial);

  struct Found {
    size_t broken = 0;
    double length = 0;  // m, of the largest cluster of broken bonds
    double energy = 0;  // J, what held the broken bonds at the start
  };
  // `moved`: m, displacement of each particle since `initial`.
  Found look(const std::vector<Vec3>& moved) const;
  size_t bonds() const { return bonds_.size(); }

 private:
  struct Bond {
    uint32_t i, j;  // places in the probe's set
    auto operator<=>(const Bond&) const = default;
  };
  int type(uint32_t at) const { return probe_.types[at]; }
  Vec3 initial(const Bond& bond) const {  // m, from i to j
    const Vec3 d = x_[bond.j] - x_[bond.i];
    return !repeats_ || d.squaredNorm() < probe_.bond_length * probe_.bond_length
               ? d
               : nearest_image(d, periodic_);
  }
  std::vector<Bond> broken(const std::vector<Vec3>& moved) const;
  double length(const std::vector<Bond>& broken) const;

  Probe probe_;
  Periodic periodic_;
  bool repeats_;             // along some axis
  std::vector<Vec3> x_;      // m, of the set where its bonds are taken
  std::vector<Vec3> ahead_;  // m, from `initial` to there; empty: none
  std::vector<Bond> bonds_;  // ascending, so that no sum depends on how cells cut the space
};

}  // namespace cuboct
