// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>
#include <cmath>

#include "emu/lattice/impl.h"

namespace cuboct::emu {
namespace {

// Two lists, as in Verlet's method: the far one holds pairs up to the cutoff plus a skin, in cells; it is
// searched anew when some particle may have moved half of that. The near one is what the far one leaves
// within the cutoff plus a thinner skin, and is taken from it every few steps (a dual pair list: Pall et al.,
// J. Chem. Phys. 153, 134110, 2020). The far skin grows while its lists hold for less than kShortLife steps.
constexpr double kMostSkin = 0.5;
constexpr uint64_t kShortLife = 20;
// A list is mended where at most this share of the particles moved farther than this share of the skin.
constexpr double kMostMended = 0.1;
constexpr double kMendFrom = 0.125;
// The near list's skin: at least so many cells, and enough for so many steps.
constexpr double kNearSkin = 0.04;
constexpr double kNearSteps = 4;
// At most this share of the far skin.
constexpr double kMostNear = 0.4;
// A near list this much wider than need be is made anew everywhere.
constexpr double kWaste = 0.7;
// Entries with fewer pairs than this on average are not what storage in rows is for: particles are stored by
// cell then.
constexpr double kFewLanes = 2.5;

}  // namespace

double LatticeEngine::Impl::reach_of_step() const {
  return std::ldexp(fastest_ + 2 * std::ldexp(1.0, plan_.rule.widths.guard),
                    -plan_.rule.widths.velocity_frac());
}

// Calls see(index) for each that may have moved since the far list was made.
template <typename See>
void LatticeEngine::Impl::for_each_moved(const See& see) const {
  if (const CellSet* moved = quiet_ ? quiet_->moved() : nullptr)
    moved->for_each(rows_, [&](uint32_t n) {
      members_.for_each(n, [&](uint32_t id) {
        if (const uint32_t p = index_(id); p < stored_) see(p);
      });
    });
  else
    for_each_index(see);
}

double LatticeEngine::Impl::displacement() const {
  double most = 0;
  if (!quiet_ || quiet_->moved() == nullptr)
    for (const Block& block : blocks_)
      most = std::max(most, snapshot_.displacement(particles_, block.begin, block.end));
  else
    for_each_moved([&](uint32_t p) { most = std::max(most, snapshot_.moved(particles_, p)); });
  if (shared()) options_.ranks->most({&most, 1});
  return most;
}

// The span of cells of each group.
void LatticeEngine::Impl::find_group_cells() {
  particles_.group_cells.assign(stored_ / kGroup + 1, {0, 0});  // an entry may overhang the last group
  for_each_block([&](Block& block) {
    for (uint32_t base = block.begin; base < block.end; base += kGroup) {
      const uint32_t* cell = particles_.cell + base;
      const auto [low, high] = std::minmax_element(cell, cell + std::min(kGroup, block.end - base));
      particles_.group_cells[base / kGroup] = {*low, *high - *low + 1};
    }
  });
}

void LatticeEngine::Impl::widen_group_cells(uint32_t index) {
  auto& [low, span] = particles_.group_cells[index / kGroup];
  const uint32_t cell = particles_.cell[index], high = std::max(low + span - 1, cell);
  low = std::min(low, cell);
  span = high - low + 1;
}

// Whether the order of storage lets an entry hold several pairs.
bool LatticeEngine::Impl::crystal() const {
  size_t entries = 0, pairs = 0;
  for (const Block& block : blocks_) {
    entries += block.inside.entries.size();
    for (const Entry& e : block.inside.entries) pairs += static_cast<size_t>(std::popcount(e.lanes));
  }
  return static_cast<double>(pairs) >= kFewLanes * static_cast<double>(entries);
}

void LatticeEngine::Impl::build() {
  if (listed_ && step_ - listed_at_ < kShortLife) skin_ = std::min(kMostSkin, skin_ * 1.3);
  summed_ = false;  // particles may be stored anew
  wrap();
  if (shared())
    redistribute();
  else if (listed_ && !crystal())
    store_by_cell(), ++counters_.sorts;
  {
    Bins bins(lattice_, members_, index_, particles_, snapshot_.position_frac, threads_);
    if (rounds_) rounds_->cut(blocks_.size());
    for_each_block([&](Block& block) {
      Search search(lattice_, rows_, cutoff_ + skin_, bins);
      if (rounds_ && rounds_->bonded())
        rounds_->list_bonds(number_of(block), block, particles_, index_);
      else
        build_list(rule_, particles_, stored_, std::move(search), block);
    });
    bins.release_to(snapshot_);
  }
  ++counters_.list_builds;
  listed_ = true;
  listed_at_ = step_;
  moved_ = 0;
  near_floor_ = -1;
  if (quiet_) {
    quiet_->forget_moved();
    find_group_cells();
  }
}

// Where few particles moved far, as around a crack or an impact: lists anew the groups of those, and of all
// around where they are now. False where that is not worth it.
bool LatticeEngine::Impl::mend() {
  if (shared()) return false;
  std::vector<uint32_t> strays;
  for_each_moved([&](uint32_t p) {
    if (snapshot_.astray(lattice_, particles_, p, kMendFrom * skin_)) strays.push_back(p);
  });
  if (static_cast<double>(strays.size()) > kMostMended * count_) return false;
  for (const uint32_t p : strays)
    for (int a = 0; a < 3; ++a)  // beyond the seam of a ring: the shifts of its entries no longer hold
      if (std::floor(particles_.x[a][p] * rule_.inverse_cell) != lattice_.cell(particles_.cell[p])[a])
        return false;
  for (const uint32_t p : strays) snapshot_.look(particles_, p);
  std::vector<uint8_t> only(stored_ / kGroup);
  Search search(lattice_, rows_, cutoff_ + skin_, members_, index_, snapshot_);
  for (const uint32_t p : strays)
    for (const auto& hit :
         search.around(particles_.cell[p], {snapshot_.at[0][p], snapshot_.at[1][p], snapshot_.at[2][p]}))
      only[hit.particle / kGroup] = 1;
  for_each_block([&](Block& block) { mend_list(particles_, snapshot_, search, only, block); });
  ++counters_.list_mends;
  moved_ = displacement();
  return true;
}

// Every pair within the cutoff plus `skin` cells comes into the near list.
void LatticeEngine::Impl::prune(double skin) {
  // Groups far from all that changed since the last time keep what they have, if that was as wide.
  const uint8_t* only = quiet_ ? quiet_->take_touched() : nullptr;
  if (skin > near_floor_ || skin < kWaste * near_floor_) only = nullptr;
  if (only == nullptr) near_floor_ = skin;
  near_skin_ = skin;
  near_moved_ = 0;
  const double reach = (cutoff_ + near_floor_) * rule_.cell * (1 + 1e-9);
  for_each_block([&](Block& block) { kernels_.prune(particles_, reach, only, block); });
  ++counters_.near_lists;
  counters_.near_parts += only != nullptr;
}

// Makes sure that the near list holds every pair inside the cutoff.
void LatticeEngine::Impl::refresh_lists() {
  if (rounds_ && rounds_->bonded()) {
    if (!listed_) build();
    return;
  }
  if (listed_ && near_moved_ <= near_skin_ / 2) return;
  // The far list must hold every pair within the near list's reach.
  const auto room = [&] { return skin_ - 2 * moved_; };
  const double least = 2 * reach_of_step();
  double wanted = std::min(std::max(kNearSkin, 2 * kNearSteps * reach_of_step()), kMostNear * skin_);
  if (!listed_ || room() < wanted) {
    if (listed_) moved_ = displacement();
    if (!listed_ || room() < std::max(least, wanted / 2)) {
      if (!listed_ || !mend() || room() < least) build();
    }
    wanted = std::min(wanted, room());
  }
  prune(wanted);
}

}  // namespace cuboct::emu
