// SPDX-License-Identifier: MIT
#include "model/program/near_rows.h"

#include <algorithm>

#include "model/contract/box_deformation.h"

namespace cuboct {
namespace {

constexpr double kSkin = 0.1;  // of the reach

}  // namespace

NearRows::NearRows(double reach, const Periodic& periodic)
    : reach_(reach),
      skin_(kSkin * reach),
      box_(periodic),
      made_box_(periodic),
      cells_(reach, periodic, skin_) {}

// Where the list was made goes with the box: what particles move about that is what counts.
void NearRows::set_box(const Periodic& periodic) {
  BoxStretch(box_, periodic).carry(made_at_);
  box_ = periodic;
  cells_ = CellList(reach_, periodic, skin_);
}

bool NearRows::lasts(const std::vector<Vec3>& x) const {
  if (made_at_.size() != x.size()) return false;
  const double allowed = allowed_motion(reach_, reach_ + skin_, made_box_, box_);
  const double most = allowed > 0 ? allowed * allowed : 0;
  for (size_t i = 0; i < x.size(); ++i)
    if (!((x[i] - made_at_[i]).squaredNorm() < most)) return false;  // nor where it is not finite
  return true;
}

void NearRows::update(const std::vector<Vec3>& x) {
  if (lasts(x)) return;
  cells_.build(x);
  first_.assign(x.size() + 1, 0);
  cells_.for_each_pair(
      x, [&](uint32_t i, uint32_t j, const Vec3&, double) { ++first_[i + 1], ++first_[j + 1]; });
  for (size_t i = 0; i < x.size(); ++i) first_[i + 1] += first_[i];
  other_.resize(first_.back());
  std::vector<uint64_t> at(first_.begin(), first_.end() - 1);
  cells_.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3&, double) {
    other_[at[i]++] = j;
    other_[at[j]++] = i;
  });
  for (size_t i = 0; i < x.size(); ++i)
    std::sort(other_.begin() + static_cast<ptrdiff_t>(first_[i]),
              other_.begin() + static_cast<ptrdiff_t>(first_[i + 1]));
  made_at_ = x;
  made_box_ = box_;
}

}  // namespace cuboct
