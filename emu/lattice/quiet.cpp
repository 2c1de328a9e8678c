// SPDX-License-Identifier: MIT
#include "emu/lattice/quiet.h"

#include <algorithm>

namespace cuboct::emu {
namespace {

// Beyond this share of nodes awake, telling them apart costs more than it saves; look again after a pause.
constexpr double kMostAwake = 0.5;
constexpr int kPause = 16;

}  // namespace

Quiet::Quiet(const Lattice& lattice, size_t groups)
    : lattice_(&lattice),
      changed_flag_(lattice.size()),
      awake_flag_(lattice.size()),
      near_flag_(lattice.size()),
      group_flag_(groups) {}

void Quiet::forget() {
  for (const uint32_t n : awake_) awake_flag_[n] = 0;
  for (const uint32_t n : near_) near_flag_[n] = 0;
  for (const uint32_t g : groups_) group_flag_[g] = 0;
  awake_.clear();
  near_.clear();
  groups_.clear();
}

void Quiet::regroup(size_t groups) {
  forget();
  group_flag_.assign(groups, 0);
}

// Over the links, axis by axis: the neighbourhood of a node is what three such hops reach (a Lattice is closed).
void Quiet::dilate(std::vector<uint32_t>& nodes, std::vector<uint8_t>& flag) const {
  for (int axis = 0; axis < 3; ++axis) {
    const size_t before = nodes.size();
    for (size_t k = 0; k < before; ++k)
      for (int face = 2 * axis; face < 2 * axis + 2; ++face) {
        const uint32_t other = lattice_->neighbour(nodes[k], face);
        if (other == kNoNode || flag[other] != 0) continue;
        flag[other] = 1;
        nodes.push_back(other);
      }
  }
}

Active Quiet::next(const Members& members) {
  forget();
  const bool told = told_;
  for (const uint32_t n : changed_) changed_flag_[n] = 0;
  awake_.swap(changed_);
  changed_.clear();
  told_ = true;
  quiet_nodes_ = 0;
  if (!told) {
    awake_.clear();
    if (pause_ > 0) --pause_;
    told_ = pause_ == 0;
    return {nullptr, nullptr, told_};
  }
  for (const uint32_t n : awake_) awake_flag_[n] = 1;
  dilate(awake_, awake_flag_);
  quiet_nodes_ = lattice_->size() - awake_.size();
  if (static_cast<double>(awake_.size()) > kMostAwake * lattice_->size()) {
    pause_ = kPause;
    told_ = false;
    return {nullptr, nullptr, false};
  }
  near_ = awake_;
  for (const uint32_t n : near_) near_flag_[n] = 1;
  dilate(near_, near_flag_);
  for (const uint32_t n : near_)
    members.for_each(n, [&](uint32_t p) {
      uint8_t& flag = group_flag_[p / kGroup];
      if (flag == 0) groups_.push_back(p / kGroup);
      flag = 1;
    });
  return {group_flag_.data(), awake_flag_.data(), true};
}

}  // namespace cuboct::emu
