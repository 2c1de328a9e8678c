// SPDX-License-Identifier: MIT
#include "model/contract/lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <unordered_map>

#include "model/base/error.h"

namespace cuboct {
namespace {

bool before(const Cell& a, const Cell& b) { return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]); }

void sort_unique(std::vector<Cell>& cells) {
  if (!std::is_sorted(cells.begin(), cells.end(), before)) std::sort(cells.begin(), cells.end(), before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

struct CellHash {
  size_t operator()(const Cell& c) const {
    uint64_t hash = 0;
    for (const int32_t along : c) hash = (hash ^ static_cast<uint32_t>(along)) * 0x9e3779b97f4a7c15;
    return hash ^ hash >> 32;
  }
};

// A set of cells in blocks of 4 x 4 x 4, a bit for each: a cell's neighbours are found in few blocks.
class CellBlocks {
 public:
  // Whether it is new.
  bool add(const Cell& c) {
    const Cell block = block_of(c);
    if (last_ == nullptr || last_->first != block) last_ = &*bits_.try_emplace(block, 0).first;
    const uint64_t before = last_->second;
    last_->second |= bit_in_block(c);
    return last_->second != before;
  }

  // Remembers the blocks that it has looked up: for as long as no cell is added.
  class Look {
   public:
    explicit Look(const CellBlocks& blocks) : blocks_(blocks) {}
    bool has(const Cell& c) {
      const Cell block = block_of(c);
      // Blocks side by side have places of their own.
      Seen& seen = seen_[static_cast<size_t>((block[0] & 1) | (block[1] & 1) << 1 | (block[2] & 1) << 2)];
      if (!seen.known || seen.block != block) {
        const auto found = blocks_.bits_.find(block);
        seen = {true, block, found == blocks_.bits_.end() ? 0 : found->second};
      }
      return (seen.bits & bit_in_block(c)) != 0;
    }

   private:
    struct Seen {
      bool known = false;
      Cell block{};
      uint64_t bits = 0;
    };
    const CellBlocks& blocks_;
    std::array<Seen, 8> seen_;
  };

 private:
  static Cell block_of(const Cell& c) { return {c[0] >> 2, c[1] >> 2, c[2] >> 2}; }
  static uint64_t bit_in_block(const Cell& c) {
    return uint64_t{1} << ((c[0] & 3) | (c[1] & 3) << 2 | (c[2] & 3) << 4);
  }
  std::unordered_map<Cell, uint64_t, CellHash> bits_;
  std::pair<const Cell, uint64_t>* last_ = nullptr;
};

// The ways between neighbours fill the box around all that hangs together: of a rod that slants its length to
// the third. So many cells are made of those that were asked for, so many in any case, and so many more at
// most.
constexpr size_t kMostClosed = 8, kAlwaysClosed = 2'000'000, kMostAdded = 8'000'000;

[[noreturn]] void refuse_closure(size_t asked, size_t most) {
  throw InputError(
      fmt::format("more than {} cells are needed around the {} that particles reach: a body that "
                  "slants takes all cells of the box around it",
                  most, asked),
      "turn its length along an axis, or a larger pitch")
      .about({"geometry", "packing.pitch", "box", "particles.file", "particle"});
}

constexpr int bit_of(int dx, int dy, int dz) { return 13 + dx + 3 * dy + 9 * dz; }

// For each offset from a cell, the cells on the ways there and back, as bits.
constexpr std::array<uint32_t, 27> kWays = [] {
  std::array<uint32_t, 27> ways{};
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx != 0) + (dy != 0) + (dz != 0) < 2) continue;
        for (const int on_way : {bit_of(dx, 0, 0), bit_of(dx, dy, 0), bit_of(0, dy, dz), bit_of(0, 0, dz)})
          ways[static_cast<size_t>(bit_of(dx, dy, dz))] |= 1u << on_way;
      }
  return ways;
}();

}  // namespace

Lattice::Lattice(std::vector<Cell> cells, Cell period) : period_(period), cells_(std::move(cells)) {
  for (Cell& c : cells_) c = wrapped(c);
  sort_unique(cells_);
  close();
  cells_.shrink_to_fit();
  rows_.shrink_to_fit();
  link();
}

Cell Lattice::wrapped(Cell cell) const {
  for (int a = 0; a < 3; ++a)
    if (period_[a] > 0 && (cell[a] < 0 || cell[a] >= period_[a]))
      cell[a] = (cell[a] % period_[a] + period_[a]) % period_[a];
  return cell;
}

size_t Lattice::row_at(int32_t z, int32_t y) const {
  if (rows_.empty()) return 0;
  const auto end = rows_.end() - 1;
  const auto it = std::lower_bound(rows_.begin(), end, std::pair(z, y), [](const Row& row, const auto& at) {
    return std::pair(row.z, row.y) < at;
  });
  return static_cast<size_t>((it != end && it->z == z && it->y == y ? it : end) - rows_.begin());
}

uint32_t Lattice::find(const Cell& cell) const {
  const Cell c = wrapped(cell);
  const size_t row = row_at(c[2], c[1]);
  return row + 1 < rows_.size() ? in_row({rows_[row].first, rows_[row + 1].first}, c[0]) : kNoCell;
}

uint32_t Lattice::in_row(const Span& row, int32_t x) const {
  // As x ascends, the cell stands no later than it would in a row without gaps, and mostly there.
  const int64_t ahead = int64_t{x} - cells_[row.begin][0];
  if (ahead < 0) return kNoCell;
  const auto end = static_cast<uint32_t>(std::min<int64_t>(row.end, row.begin + ahead + 1));
  if (cells_[end - 1][0] == x) return end - 1;
  const auto it = std::lower_bound(cells_.begin() + row.begin, cells_.begin() + end, x,
                                   [](const Cell& cell, int32_t at) { return cell[0] < at; });
  return it != cells_.begin() + end && (*it)[0] == x ? static_cast<uint32_t>(it - cells_.begin()) : kNoCell;
}

void Lattice::index_rows() {
  rows_.clear();
  for (uint32_t n = 0; n < size(); ++n)
    if (n == 0 || cells_[n][1] != cells_[n - 1][1] || cells_[n][2] != cells_[n - 1][2])
      rows_.push_back({cells_[n][2], cells_[n][1], n});
  rows_.push_back({0, 0, size()});
}

Lattice::Span Lattice::around(size_t row, int dz, int dy) const {
  const Cell at = wrapped({0, rows_[row].y + dy, rows_[row].z + dz});
  const size_t other = row_at(at[2], at[1]);
  return other + 1 < rows_.size() ? Span{rows_[other].first, rows_[other + 1].first} : Span{};
}

// Whether `row` holds x - 1 or x + 1; `at` is its first cell not below x - 1.
bool Lattice::neighbours_in_x(const Span& row, uint32_t at, int32_t x) const {
  for (uint32_t k = at; k < row.end && cells_[k][0] <= x + 1; ++k)
    if (cells_[k][0] != x) return true;
  if (period_[0] == 0 || row.begin == row.end) return false;
  return (x == 0 && cells_[row.end - 1][0] == period_[0] - 1) ||
         (x == period_[0] - 1 && cells_[row.begin][0] == 0);
}

// What the ways from the cells of `row` (y, z) to those of its neighbour `other` (y + dy, z + dz) lack. A way
// goes by x, then y, then z. From (x, y, z) to x' = x +- 1 in `other` it passes (x', y, z), in `row`, and,
// where it goes on by y and by z, (x', y + dy, z), in the row called `middle`. With x' = x only the latter is
// new.
void Lattice::missing_between(size_t row, int dz, int dy, std::vector<Cell>& missing) const {
  const Span other = around(row, dz, dy);
  if (other.begin == other.end) return;
  const Span own{rows_[row].first, rows_[row + 1].first};
  const bool corner = dy != 0 && dz != 0;
  const Span middle = corner ? around(row, 0, dy) : Span{};
  const int32_t middle_y = wrapped({0, rows_[row].y + dy, 0})[1];
  uint32_t in_own = own.begin, in_middle = middle.begin;
  for (uint32_t n = other.begin; n < other.end; ++n) {
    const int32_t x = cells_[n][0];
    while (in_own < own.end && cells_[in_own][0] < x - 1) ++in_own;
    bool same = false;
    for (uint32_t k = in_own; k < own.end && cells_[k][0] <= x; ++k) same = cells_[k][0] == x;
    const bool aside = (!same || corner) && neighbours_in_x(own, in_own, x);
    if (aside && !same) missing.push_back({x, rows_[row].y, rows_[row].z});
    if (!corner || !(aside || same)) continue;
    while (in_middle < middle.end && cells_[in_middle][0] < x) ++in_middle;
    if (in_middle == middle.end || cells_[in_middle][0] != x) missing.push_back({x, middle_y, rows_[row].z});
  }
}

// A cell that is added may start further ways, so this goes on until nothing is missing. After the first
// round only what is around new cells can be.
void Lattice::close() {
  index_rows();
  std::vector<Cell> missing;
  for (size_t row = 0; row + 1 < rows_.size(); ++row)
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        if (dy != 0 || dz != 0) missing_between(row, dz, dy, missing);
  sort_unique(missing);
  if (missing.empty()) return;
  CellBlocks all;
  for (const Cell& c : cells_) all.add(c);
  const auto beside = [this](const Cell& c, int bit) {
    return wrapped({c[0] + bit % 3 - 1, c[1] + bit / 3 % 3 - 1, c[2] + bit / 9 - 1});
  };
  // The sorted cells get them after the last round: along a needle there are as many rounds as cells.
  const auto middle = static_cast<ptrdiff_t>(cells_.size());
  const size_t most =
      std::max(kAlwaysClosed, cells_.size() + std::min((kMostClosed - 1) * cells_.size(), kMostAdded));
  for (; !missing.empty(); sort_unique(missing)) {
    for (const Cell& c : missing)
      if (all.add(c)) cells_.push_back(c);
    if (cells_.size() > most) refuse_closure(static_cast<size_t>(middle), most);
    CellBlocks::Look look(all);
    std::vector<Cell> next;
    for (const Cell& c : missing) {
      uint32_t present = 0, needed = 0;
      for (int bit = 0; bit < 27; ++bit)
        if (look.has(beside(c, bit))) present |= 1u << bit, needed |= kWays[static_cast<size_t>(bit)];
      needed &= ~present;
      for (int bit = 0; needed >> bit != 0; ++bit)
        if ((needed >> bit & 1) != 0) next.push_back(beside(c, bit));
    }
    missing = std::move(next);
  }
  std::sort(cells_.begin() + middle, cells_.end(), before);
  std::inplace_merge(cells_.begin(), cells_.begin() + middle, cells_.end(), before);
  index_rows();
}

void Lattice::link() {
  std::array<uint32_t, kFaces> none;
  none.fill(kNoCell);
  neighbour_.assign(cells_.size(), none);
  for (size_t row = 0; row + 1 < rows_.size(); ++row) {
    const Span own{rows_[row].first, rows_[row + 1].first};
    for (uint32_t n = own.begin; n + 1 < own.end; ++n)
      if (cells_[n + 1][0] == cells_[n][0] + 1) {
        neighbour_[n][1] = n + 1;
        neighbour_[n + 1][0] = n;
      }
    if (period_[0] > 0 && cells_[own.begin][0] == 0 && cells_[own.end - 1][0] == period_[0] - 1) {
      neighbour_[own.begin][0] = own.end - 1;
      neighbour_[own.end - 1][1] = own.begin;
    }
    for (int face = 2; face < kFaces; ++face) {
      const int way = face % 2 == 1 ? 1 : -1;
      const Span other = face < 4 ? around(row, 0, way) : around(row, way, 0);
      uint32_t m = other.begin;
      for (uint32_t n = own.begin; n < own.end; ++n) {
        while (m < other.end && cells_[m][0] < cells_[n][0]) ++m;
        if (m < other.end && cells_[m][0] == cells_[n][0]) neighbour_[n][static_cast<size_t>(face)] = m;
      }
    }
  }
}

std::vector<Lattice::Near> Lattice::neighbourhood(uint32_t cell) const {
  const auto hop = [this](uint32_t from, int axis, int way) {
    return way == 0 || from == kNoCell ? from : neighbour_[from][2 * axis + (way > 0)];
  };
  std::vector<Near> near;
  near.reserve(27);
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const uint32_t other = hop(hop(hop(cell, 0, dx), 1, dy), 2, dz);
        if (other != kNoCell) near.push_back({other, {dx, dy, dz}});
      }
  return near;
}

}  // namespace cuboct
