// SPDX-License-Identifier: MIT
#include "emu/lattice/search.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace cuboct::emu {
namespace {

// c modulo n, and which image of the ring that was; n 0: not a ring.
std::pair<int32_t, int> wrapped(int32_t c, int32_t n) {
  if (n == 0) return {c, 0};
  if (c < 0) return {c + n, -1};
  if (c >= n) return {c - n, +1};
  return {c, 0};
}

}  // namespace

Rows::Rows(const Lattice& lattice) : lattice_(lattice), row_of_(lattice.size()) {
  std::map<std::pair<int32_t, int32_t>, uint32_t> index;  // (z, y)
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    const Cell& c = lattice.cell(n);
    if (n == 0 || c[1] != lattice.cell(n - 1)[1] || c[2] != lattice.cell(n - 1)[2]) {
      index.emplace_hint(index.end(), std::pair(c[2], c[1]), static_cast<uint32_t>(rows_.size()));
      rows_.push_back({n, n});
    }
    rows_.back().end = n + 1;
    row_of_[n] = static_cast<uint32_t>(rows_.size()) - 1;
  }
  near_.resize(rows_.size());
  const Cell& period = lattice.period();
  for (size_t r = 0; r < rows_.size(); ++r) {
    const Cell& c = lattice.cell(rows_[r].begin);
    for (int dz = -kReach; dz <= kReach; ++dz)
      for (int dy = -kReach; dy <= kReach; ++dy) {
        const auto at =
            index.find({wrapped(c[2] + dz, period[2]).first, wrapped(c[1] + dy, period[1]).first});
        near_[r][static_cast<size_t>((dz + kReach) * (2 * kReach + 1) + dy + kReach)] =
            at == index.end() ? kNoCell : at->second;
      }
  }
}

bool Rows::whole(uint32_t row) const {
  const Range& r = rows_[row];
  return lattice_.cell(r.end - 1)[0] - lattice_.cell(r.begin)[0] + 1 == static_cast<int32_t>(r.end - r.begin);
}

Rows::Range Rows::cells(uint32_t row, int32_t low, int32_t high) const {
  const Range& r = rows_[row];
  const int32_t x0 = lattice_.cell(r.begin)[0], x1 = lattice_.cell(r.end - 1)[0];
  if (low > x1 || high < x0) return {r.begin, r.begin};
  if (whole(row))
    return {r.begin + static_cast<uint32_t>(std::max(low - x0, 0)),
            r.begin + static_cast<uint32_t>(std::min(high, x1) - x0) + 1};
  const auto first = [&](int32_t x) {
    uint32_t a = r.begin, b = r.end;
    while (a < b) {
      const uint32_t m = (a + b) / 2;
      if (lattice_.cell(m)[0] < x)
        a = m + 1;
      else
        b = m;
    }
    return a;
  };
  return {first(low), first(high + 1)};
}

Search::Search(const Lattice& lattice, const Rows& rows, double reach) : lattice_(lattice), rows_(rows) {
  // Coordinates are rounded down to 2^-kCoarse, so a difference is wrong by less than one unit per axis;
  // floats add less than one part in 10^6.
  const double units = std::ldexp(reach, kCoarse) + std::sqrt(3.0);
  reach_ = static_cast<int32_t>(std::ceil(units));
  reach2_ = static_cast<float>(units * units * (1 + 1e-6));
}

Search::Search(const Lattice& lattice, const Rows& rows, double reach, const Bins& bins)
    : Search(lattice, rows, reach) {
  bins_ = &bins;
}

Search::Search(const Lattice& lattice, const Rows& rows, double reach, const Members& members,
               const Index& index, const Snapshot& snapshot)
    : Search(lattice, rows, reach) {
  members_ = &members;
  index_ = &index;
  snapshot_ = &snapshot;
}

void Search::add(Rows::Range cells, const std::array<int32_t, 3>& at, uint8_t shift) {
  if (cells.begin == cells.end) return;
  if (bins_ == nullptr) {
    for (uint32_t n = cells.begin; n < cells.end; ++n)
      members_->for_each(n, [&](uint32_t id) {
        const uint32_t p = (*index_)(id);
        float r2 = 0;
        for (int a = 0; a < 3; ++a) {
          const auto d = static_cast<float>(static_cast<int32_t>(static_cast<uint32_t>(snapshot_->at[a][p]) -
                                                                 static_cast<uint32_t>(at[a])));
          r2 += d * d;
        }
        if (r2 <= reach2_) hits_.push_back({p, shift});
      });
    return;
  }
  const uint32_t begin = bins_->first[cells.begin], count = bins_->first[cells.end] - begin;
  if (count == 0) return;
  found_.resize(std::max<size_t>(found_.size(), count + 16));
  const uint32_t n = within(&bins_->at[0][begin], &bins_->at[1][begin], &bins_->at[2][begin], count,
                            at.data(), reach2_, found_.data());
  for (uint32_t k = 0; k < n; ++k) hits_.push_back({bins_->particle[begin + found_[k]], shift});
}

const std::vector<Search::Hit>& Search::around(uint32_t cell, const std::array<int32_t, 3>& at) {
  hits_.clear();
  const Cell& centre = lattice_.cell(cell);
  const Cell& period = lattice_.period();
  // The cells that [x - reach, x + reach] touches, relative to the particle's own.
  std::array<int, 3> low, high;
  for (int a = 0; a < 3; ++a) {
    const int32_t local = at[a] & ((1 << kCoarse) - 1);
    low[a] = (local - reach_) >> kCoarse;
    high[a] = (local + reach_) >> kCoarse;
  }
  const uint32_t row = rows_.row_of(cell);
  for (int dz = low[2]; dz <= high[2]; ++dz) {
    const int image_z = wrapped(centre[2] + dz, period[2]).second;
    for (int dy = low[1]; dy <= high[1]; ++dy) {
      const uint32_t other = rows_.near(row, dy, dz);
      if (other == kNoCell) continue;
      const int image_y = wrapped(centre[1] + dy, period[1]).second;
      // Images of the ring along x are stretches of their own.
      for (int image_x = period[0] > 0 ? -1 : 0; image_x <= (period[0] > 0 ? 1 : 0); ++image_x) {
        const int32_t a = centre[0] + low[0] - image_x * period[0],
                      b = centre[0] + high[0] - image_x * period[0];
        if (period[0] > 0 && (b < 0 || a >= period[0])) continue;
        const auto moved = [](int32_t value, int image, int32_t cells) {
          return static_cast<int32_t>(static_cast<uint32_t>(value) -
                                      (static_cast<uint32_t>(image * cells) << kCoarse));
        };
        add(rows_.cells(other, a, b),
            {moved(at[0], image_x, period[0]), moved(at[1], image_y, period[1]),
             moved(at[2], image_z, period[2])},
            static_cast<uint8_t>(image_x + 1 + 3 * (image_y + 1) + 9 * (image_z + 1)));
      }
    }
  }
  return hits_;
}

}  // namespace cuboct::emu
