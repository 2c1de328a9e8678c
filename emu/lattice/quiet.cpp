// SPDX-License-Identifier: MIT
#include "emu/lattice/quiet.h"

#include <algorithm>
#include <numeric>

namespace cuboct::emu {
namespace {

// Beyond this share of cells awake, telling them apart costs more than it saves; look again after a pause.
constexpr double kMostAwake = 0.8;
constexpr int kPause = 16;

}  // namespace

void CellSet::survey(const Rows& rows) {
  for (uint32_t r = 0; r < row_.size(); ++r) {
    const auto [begin, end] = rows.row(r);
    uint8_t any = 0;
    for (uint32_t n = begin; n < end; ++n) any |= flag_[n];
    row_[r] = any;
  }
}

void CellSet::clear(const Rows& rows) {
  for (uint32_t r = 0; r < row_.size(); ++r) {
    if (row_[r] == 0) continue;
    const auto [begin, end] = rows.row(r);
    std::fill(flag_.begin() + begin, flag_.begin() + end, uint8_t{0});
    row_[r] = 0;
  }
}

void CellSet::add(const CellSet& other, const Rows& rows) {
  for (uint32_t r = 0; r < row_.size(); ++r) {
    if (other.row_[r] == 0) continue;
    row_[r] = 1;
    const auto [begin, end] = rows.row(r);
    for (uint32_t n = begin; n < end; ++n) flag_[n] |= other.flag_[n];
  }
}

uint64_t CellSet::count(const Rows& rows) const {
  uint64_t count = 0;
  for (uint32_t r = 0; r < row_.size(); ++r)
    if (row_[r] != 0)
      count = std::accumulate(flag_.begin() + rows.row(r).begin, flag_.begin() + rows.row(r).end, count);
  return count;
}

void CellSet::spread_x(const CellSet& other, const Lattice& lattice, const Rows& rows) {
  for (uint32_t r = 0; r < row_.size(); ++r) {
    if (other.row_[r] == 0) continue;
    row_[r] = 1;
    const auto [begin, end] = rows.row(r);
    const uint8_t* from = other.flag_.data();
    uint8_t* to = flag_.data();
    if (rows.whole(r)) {
      for (uint32_t n = begin; n < end; ++n) to[n] |= from[n];
      for (uint32_t n = begin + 1; n < end; ++n) to[n] |= from[n - 1];
      for (uint32_t n = begin; n + 1 < end; ++n) to[n] |= from[n + 1];
      const uint32_t before = lattice.neighbour(begin, 0), behind = lattice.neighbour(end - 1, 1);
      if (before != kNoCell) to[before] |= from[begin];  // around a ring
      if (behind != kNoCell) to[behind] |= from[end - 1];
      continue;
    }
    for (uint32_t n = begin; n < end; ++n) {
      if (from[n] == 0) continue;
      to[n] = 1;
      for (const int face : {0, 1})
        if (const uint32_t beside = lattice.neighbour(n, face); beside != kNoCell) to[beside] = 1;
    }
  }
}

// Adds `other` moved by (0, dy, dz).
void CellSet::spread_rows(const CellSet& other, int dy, int dz, const Lattice& lattice, const Rows& rows) {
  for (uint32_t r = 0; r < row_.size(); ++r) {
    if (other.row_[r] == 0) continue;
    const uint32_t t = rows.near(r, dy, dz);
    if (t == kNoCell) continue;
    row_[t] = 1;
    const auto [begin, end] = rows.row(r);
    if (rows.whole(r) && rows.whole(t)) {
      const int32_t x = lattice.cell(begin)[0], to_x = lattice.cell(rows.row(t).begin)[0];
      const int32_t low = std::max(x, to_x);
      const int32_t high = std::min(x + static_cast<int32_t>(end - begin),
                                    to_x + static_cast<int32_t>(rows.row(t).end - rows.row(t).begin));
      const uint8_t* from = other.flag_.data() + begin + (low - x);
      uint8_t* to = flag_.data() + rows.row(t).begin + (low - to_x);
      for (int32_t k = 0; k < high - low; ++k) to[k] |= from[k];
      continue;
    }
    for (uint32_t n = begin; n < end; ++n) {
      if (other.flag_[n] == 0) continue;
      const int32_t x = lattice.cell(n)[0];
      const auto [at, behind] = rows.cells(t, x, x);
      if (at != behind) flag_[at] = 1;
    }
  }
}

void CellSet::dilate(const CellSet& other, const Lattice& lattice, const Rows& rows) {
  thread_local CellSet x, xy;  // empty between calls: the next one may be of another lattice
  for (CellSet* set : {&x, &xy})
    if (set->flag_.size() != flag_.size() || set->row_.size() != row_.size()) *set = CellSet(lattice, rows);
  clear(rows);
  x.spread_x(other, lattice, rows);
  for (const int dy : {-1, 0, 1}) xy.spread_rows(x, dy, 0, lattice, rows);
  for (const int dz : {-1, 0, 1}) spread_rows(xy, 0, dz, lattice, rows);
  x.clear(rows);
  xy.clear(rows);
}

Quiet::Quiet(const Lattice& lattice, const Rows& rows, int rounds)
    : lattice_(&lattice),
      rows_(&rows),
      rounds_(rounds),
      changed_(lattice, rows),
      awake_(lattice, rows),
      near_(lattice, rows),
      touched_(lattice, rows),
      moved_(lattice, rows),
      spare_(lattice, rows) {}

Active Quiet::next() {
  quiet_cells_ = 0;
  telling_ = true;
  if (!told_) {
    if (pause_ > 0) --pause_;
    telling_ = pause_ == 0;
    return {nullptr, nullptr, telling_ ? changed_.flags() : nullptr};
  }
  awake_.dilate(changed_, *lattice_, *rows_);
  for (int k = 1; k < rounds_; ++k) {
    spare_ = awake_;
    awake_.dilate(spare_, *lattice_, *rows_);
  }
  changed_.clear(*rows_);
  const uint64_t awake = awake_.count(*rows_);
  quiet_cells_ = lattice_->size() - awake;
  if (static_cast<double>(awake) > kMostAwake * lattice_->size()) {
    pause_ = kPause;
    telling_ = false;
    return {};
  }
  near_.dilate(awake_, *lattice_, *rows_);
  return {near_.flags(), awake_.flags(), changed_.flags()};
}

void Quiet::done(Ranks* ranks) {
  told_ = telling_;
  if (!told_) {
    touched_all_ = moved_all_ = true;
    return;
  }
  if (ranks != nullptr) ranks->any({changed_.flags(), lattice_->size()});
  changed_.survey(*rows_);
  if (!touched_all_) touched_.add(changed_, *rows_);
  if (!moved_all_) moved_.add(changed_, *rows_);
}

const uint8_t* Quiet::take_touched() {
  const bool all = touched_all_;
  touched_all_ = false;
  if (!all) {
    spare_.dilate(touched_, *lattice_, *rows_);
    CellSet twice = spare_;
    twice.dilate(spare_, *lattice_, *rows_);
    spare_.dilate(twice, *lattice_, *rows_);
  }
  touched_.clear(*rows_);
  return all ? nullptr : spare_.flags();
}

void Quiet::forget_moved() {
  moved_all_ = false;
  moved_.clear(*rows_);
}

}  // namespace cuboct::emu
