// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "emu/lattice/impl.h"
#include "model/base/error.h"

namespace cuboct::emu {
namespace {

auto order(const RunError& e) { return std::tuple(e.fault, e.particle, e.number); }

bool is_full(Fault fault) {
  return fault == Fault::full_x || fault == Fault::full_y || fault == Fault::full_z;
}

}  // namespace

RunError LatticeEngine::Impl::error(Fault fault, uint32_t cell, uint32_t id, int64_t number) const {
  const Cell& c = lattice_.cell(cell);
  return {fault, step_, cell, id, number, fmt::format(" at ({}, {}, {})", c[0], c[1], c[2])};
}

void LatticeEngine::Impl::fail_if_any(std::vector<RunError> faults) const {
  if (faults.empty()) return;
  throw *std::min_element(faults.begin(), faults.end(),
                          [](const auto& a, const auto& b) { return order(a) < order(b); });
}

// The least fault of all ranks, the same on each.
void LatticeEngine::Impl::fail_if_any(std::vector<Found> Block::*faults) const {
  struct Told {
    Fault fault;
    uint32_t cell, id;
    int64_t number;
  };
  Bytes mine;
  for (const Block& block : blocks_)
    for (const Found& f : block.*faults) {
      const uint32_t id = particles_.id_of(f.particle);
      append(mine, Told{f.fault, members_.cells()[id], id, f.number});
    }
  const Bytes all = shared() ? options_.ranks->all(mine) : mine;
  std::vector<RunError> errors;
  for_each_of<Told>(
      all, [&](const Told& told) { errors.push_back(error(told.fault, told.cell, told.id, told.number)); });
  fail_if_any(errors);
}

// By id, of all ranks.
std::vector<Crossing> LatticeEngine::Impl::all_crossings() const {
  std::vector<Crossing> crossings;
  for (const Block& block : blocks_)
    for (const Crossing& c : block.crossings) crossings.push_back({particles_.id_of(c.particle), c.away});
  if (!shared()) return crossings;
  Bytes mine;
  for (const Crossing& c : crossings) append(mine, c);
  crossings.clear();
  for_each_of<Crossing>(options_.ranks->all(mine), [&](const Crossing& c) { crossings.push_back(c); });
  return crossings;
}

// The ghosts travel while all that does not need them is worked on.
void LatticeEngine::Impl::forces_and_update(const Active& active) {
  const std::vector<PaddedArray<double>*> arrays = halo();
  if (shared()) start_halo(arrays);
  for_each_block([&](Block& block) { kernels_.across(rule_, particles_, active, block.beside, block); });
  for_each_block([&](Block& block) {
    if (block.ghosts.group.empty()) kernels_.inside(rule_, particles_, active, block);
  });
  if (!shared()) return;
  finish_halo(arrays);
  for_each_block([&](Block& block) {
    if (block.ghosts.group.empty()) return;
    kernels_.across(rule_, particles_, active, block.ghosts, block);
    kernels_.inside(rule_, particles_, active, block);
  });
}

void LatticeEngine::Impl::clear_blocks() {
  for (Block& block : blocks_) {
    block.crossings.clear();
    block.pair_faults.clear();
    block.update_faults.clear();
    block.fastest2 = 0;
  }
}

void LatticeEngine::Impl::take_pairs() {
  refresh_lists();
  const Active active = quiet_ ? quiet_->next() : Active();
  clear_blocks();
  if (std::exchange(summed_, false))
    for_each_block([&](Block& block) { kernels_.update(rule_, particles_, active, sums_.data(), block); });
  else
    forces_and_update(active);
}

void LatticeEngine::Impl::step() {
  rounds_ ? take_rounds() : take_pairs();

  // The largest speed, and whether some rank met a fault of each kind.
  std::array<double, 3> most{};
  for (const Block& block : blocks_) {
    most[0] = std::max(most[0], std::sqrt(block.fastest2));
    most[1] = std::max(most[1], block.pair_faults.empty() ? 0.0 : 1.0);
    most[2] = std::max(most[2], block.update_faults.empty() ? 0.0 : 1.0);
  }
  if (shared()) options_.ranks->most(most);
  if (most[1] > 0) fail_if_any(&Block::pair_faults);
  if (most[2] > 0) fail_if_any(&Block::update_faults);

  const std::vector<Crossing> crossings = all_crossings();
  std::vector<RunError> faults;
  for (const Refused& r : members_.migrate(crossings, leaving_))
    faults.push_back(error(r.fault, r.cell, r.particle, is_full(r.fault) ? plan_.arch.capacity : 0));
  fail_if_any(faults);
  for (const Crossing& c : crossings) {
    const uint32_t index = index_(c.particle);
    if (index == kNoParticle || index >= stored_) continue;
    if (cell_.size() > 0) cell_[index] = members_.cells()[c.particle];
    if (!quiet_) continue;
    quiet_->changed(particles_.cell[index]);
    widen_group_cells(index);
  }
  if (quiet_) quiet_->done(options_.ranks);

  fastest_ = most[0];
  moved_ += reach_of_step();
  near_moved_ += reach_of_step();
  counters_.node_steps += lattice_.size();
  if (quiet_) counters_.quiet_node_steps += quiet_->quiet_cells();
  ++step_;
}

}  // namespace cuboct::emu
