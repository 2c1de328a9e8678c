// SPDX-License-Identifier: MIT
// The near list: the pairs nearer than a cutoff and a skin, exact until some particle has moved half the
// skin. L. Verlet, Phys. Rev. 159 (1967) 98.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "model/contract/neighbours.h"
#include "model/real/pair_kernel.h"

namespace cuboct {

class NearWalk;

class NearList {
 public:
  // InputError as of CellList. `lanes` particles make a group. Rounding may bring pairs nearer by `margin`
  // (m): that much beyond the cutoff they are listed always.
  NearList(double cutoff, const Periodic& periodic, double margin, size_t lanes, int threads);

  // Gives each particle a slot, by cells, and lists its neighbours by ascending id: a sum over them does not
  // depend on slots, nor on when lists were made. std::runtime_error where a position is not finite.
  void build(std::span<const Vec3> x);
  // The box has become this one: of the same axes. The lists stay.
  void set_box(const Periodic& periodic, double margin);
  // Lists from now on have the skin that costs least, were the fastest particle to go on at `speed` (m per
  // step).
  void plan(std::span<const Vec3> x, double speed);

  double skin() const { return skin_; }                          // m
  std::span<const uint32_t> order() const { return order_; }     // [slot]: id
  size_t slots() const { return groups_ * lanes_; }              // rounded up to whole groups
  const std::vector<PairRows>& parts() const { return parts_; }  // one per thread
  std::vector<PairRows>& parts() { return parts_; }

  // The shortest vector from a to b in m, over images.
  Vec3 difference(const Vec3& a, const Vec3& b) const { return nearest_.difference(a, b); }

 private:
  void fill(const NearWalk& walk, PairRows& part, size_t end_group) const;

  double cutoff_, margin_;
  Periodic periodic_;
  CellList nearest_;
  size_t lanes_;
  int threads_;
  double skin_ = 0;
  size_t groups_ = 0;
  std::vector<uint32_t> order_;
  std::vector<PairRows> parts_;
};

}  // namespace cuboct
