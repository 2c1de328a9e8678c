// SPDX-License-Identifier: MIT
// For each particle the others within reach now, by ascending id: rows of a full list with a skin, made anew
// once particles have moved by half of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "model/contract/neighbours.h"

namespace cuboct {

class NearRows {
 public:
  // m. InputError where a periodic extent is below two reaches.
  NearRows(double reach, const Periodic& periodic);

  // The box has become this one, of the same axes. The rows stay as long as they last.
  void set_box(const Periodic& periodic);
  // std::runtime_error where a position is not finite.
  void update(const std::vector<Vec3>& x);
  // Those within reach + skin when the list was made.
  std::span<const uint32_t> row(size_t i) const {
    return {other_.data() + first_[i], first_[i + 1] - first_[i]};
  }
  Vec3 difference(const Vec3& a, const Vec3& b) const { return cells_.difference(a, b); }
  double reach() const { return reach_; }

 private:
  bool lasts(const std::vector<Vec3>& x) const;

  double reach_, skin_;
  Periodic box_, made_box_;  // of now, and of when the list was made
  CellList cells_;
  std::vector<Vec3> made_at_;
  std::vector<uint64_t> first_;
  std::vector<uint32_t> other_;
};

}  // namespace cuboct
