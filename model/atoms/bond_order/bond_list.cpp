// SPDX-License-Identifier: MIT
#include "model/atoms/bond_order/bond_list.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "model/base/dense.h"

namespace cuboct {
namespace {

// Entries are 4 times a place in 32 bits, which vectors read as signed.
constexpr size_t kMostPlaces = size_t{1} << 29;

// By how much a deformation of space shortens the vector that it shortens most.
double least_stretch(const Mat3& deformation) {
  return std::sqrt(std::max(0.0, eigenvalues<Mat3>(deformation.transpose() * deformation)[0]));
}

}  // namespace

BondList::BondList(double cutoff, double skin, size_t lanes) : cutoff_(cutoff), skin_(skin), lanes_(lanes) {}

// A pair that is not listed was `reach` apart or more. The box carries it to d = F d0 + (e_j - e_i), where F
// is the box's deformation since then and e what an atom moved besides it: |d| >= least stretch * reach - 2
// max |e|.
bool BondList::holds(const AtomBox& box, std::span<const Vec3> x) const {
  if (!valid_ || x.size() != reference_.size() || box.periodic != box_.periodic) return false;
  const bool same = box.edges == box_.edges;
  const Mat3 deformation = same ? Mat3::Identity() : Mat3(box.edges * box_.edges.inverse());
  const double room = ((cutoff_ + skin_) * (same ? 1 : least_stretch(deformation)) - cutoff_) / 2;
  if (!(room >= 0)) return false;
  const double most2 = room * room;
  // A position that is not finite fails here too: the list is made anew, which names it.
  for (size_t i = 0; i < x.size(); ++i) {
    const double moved2 =
        same ? (x[i] - reference_[i]).squaredNorm() : (x[i] - deformation * reference_[i]).squaredNorm();
    if (!(moved2 <= most2)) return false;
  }
  return true;
}

bool BondList::update(const AtomBox& box, std::span<const Vec3> x) {
  if (holds(box, x)) return false;
  make(box, x);
  return true;
}

void BondList::make(const AtomBox& box, std::span<const Vec3> x) {
  for (size_t i = 0; i < x.size(); ++i)
    if (!x[i].allFinite()) throw std::runtime_error(fmt::format("the position of atom {} is not finite", i));
  if (!(box.volume() > 0)) throw std::runtime_error("the box of the atoms has no volume");
  if (x.size() > kMostPlaces)
    throw std::runtime_error(fmt::format("{} atoms, more than {}", x.size(), kMostPlaces));
  valid_ = false;
  box_ = box;
  reference_.assign(x.begin(), x.end());
  sort_into_cells(box, x);
  find_near(box);
  name_ghosts();
  fill_rows();
  ++made_;
  valid_ = true;
}

// Cells of at least the reach along each edge, counted across the planes of the other two; as many as leave
// some atoms in each.
void BondList::sort_into_cells(const AtomBox& box, std::span<const Vec3> x) {
  const size_t n = x.size();
  const Mat3 inverse = box.edges.inverse();
  const double reach = cutoff_ + skin_;
  wrapped_.resize(n), image_.resize(n), cell_.resize(n);
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (size_t i = 0; i < n; ++i) {
    Vec3 s = inverse * x[i];
    for (int a = 0; a < 3; ++a) {
      image_[i][a] = 0;
      if (!box.periodic[a]) continue;
      const double turns = std::floor(s[a]);
      if (!(std::abs(turns) < 1e9))
        throw std::runtime_error(fmt::format("atom {} is more than 1e9 boxes away", i));
      image_[i][a] = static_cast<int32_t>(turns);
      s[a] -= turns;
    }
    wrapped_[i] = s;
    low = low.cwiseMin(s), high = high.cwiseMax(s);
  }
  if (n == 0) low = high = Vec3::Zero();
  const auto most = static_cast<double>(std::max<size_t>(1, n));
  Vec3 begin, length;
  for (int a = 0; a < 3; ++a) {
    const double across = 1 / inverse.row(a).norm();  // between the box's two faces
    begin[a] = box.periodic[a] ? 0 : low[a];
    length[a] = box.periodic[a] ? 1 : high[a] - low[a];
    const double count = std::clamp(std::floor(length[a] * across / reach), 1.0, most);
    cells_[a] = static_cast<int32_t>(count);
    const double width = length[a] * across / count;
    around_[a] = box.periodic[a] ? static_cast<int32_t>(std::ceil(reach / width)) : cells_[a] > 1 ? 1 : 0;
  }
  // A gas in a huge box: no more cells than atoms.
  while (static_cast<double>(cells_[0]) * cells_[1] * cells_[2] > 4 * most + 64) {
    const auto longest = static_cast<size_t>(std::max_element(cells_.begin(), cells_.end()) - cells_.begin());
    cells_[longest] = (cells_[longest] + 1) / 2;
    if (cells_[longest] == 1 && !box.periodic[longest]) around_[longest] = 0;
  }
  const auto cells =
      static_cast<size_t>(cells_[0]) * static_cast<size_t>(cells_[1]) * static_cast<size_t>(cells_[2]);
  cell_begin_.assign(cells + 1, 0);
  const auto number = [&](const std::array<int32_t, 3>& c) {
    return static_cast<size_t>((c[0] * cells_[1] + c[1]) * static_cast<int64_t>(cells_[2]) + c[2]);
  };
  for (size_t i = 0; i < n; ++i) {
    for (int a = 0; a < 3; ++a) {
      const double at = length[a] > 0 ? (wrapped_[i][a] - begin[a]) / length[a] * cells_[a] : 0;
      cell_[i][a] = std::clamp(static_cast<int32_t>(at), 0, cells_[a] - 1);
    }
    ++cell_begin_[number(cell_[i]) + 1];
  }
  for (size_t c = 0; c < cells; ++c) cell_begin_[c + 1] += cell_begin_[c];
  cell_atoms_.resize(n);
  for (size_t i = n; i-- > 0;) cell_atoms_[--cell_begin_[number(cell_[i]) + 1]] = static_cast<uint32_t>(i);
  // Each cell's begin was left in the place of its successor.
  for (size_t c = 0; c < cells; ++c) cell_begin_[c] = cell_begin_[c + 1];
  cell_begin_[cells] = static_cast<uint32_t>(n);
  for (size_t i = 0; i < n; ++i) wrapped_[i] = box.edges * wrapped_[i];
}

void BondList::find_near(const AtomBox& box) {
  const size_t n = reference_.size();
  const double reach2 = (cutoff_ + skin_) * (cutoff_ + skin_), coincident2 = 1e-20 * cutoff_ * cutoff_;
  near_.clear();
  near_begin_.assign(1, 0);
  for (size_t i = 0; i < n; ++i) {
    std::array<int32_t, 3> step;
    for (step[0] = -around_[0]; step[0] <= around_[0]; ++step[0])
      for (step[1] = -around_[1]; step[1] <= around_[1]; ++step[1])
        for (step[2] = -around_[2]; step[2] <= around_[2]; ++step[2]) {
          std::array<int32_t, 3> turn{};
          int64_t number = 0;
          bool inside = true;
          for (int a = 0; a < 3; ++a) {
            int32_t c = cell_[i][a] + step[a];
            if (box.periodic[a]) {
              turn[a] = c >= 0 ? c / cells_[a] : -((-c + cells_[a] - 1) / cells_[a]);
              c -= turn[a] * cells_[a];
            }
            inside = inside && c >= 0 && c < cells_[a];
            number = number * cells_[a] + c;
          }
          if (!inside) continue;
          const Vec3 home = wrapped_[i] - box.edges * Vec3(turn[0], turn[1], turn[2]);
          const bool other_image = turn[0] != 0 || turn[1] != 0 || turn[2] != 0;
          const auto cell = static_cast<size_t>(number);
          for (uint32_t k = cell_begin_[cell]; k < cell_begin_[cell + 1]; ++k) {
            const uint32_t j = cell_atoms_[k];
            const double r2 = (wrapped_[j] - home).squaredNorm();
            if (r2 >= reach2 || (j == i && !other_image)) continue;
            if (r2 <= coincident2)
              throw std::runtime_error(fmt::format("atoms {} and {} are at one point", i, j));
            Near near{j, turn};
            for (int a = 0; a < 3; ++a) near.image[a] += image_[i][a] - image_[j][a];
            near_.push_back(near);
          }
        }
    std::sort(near_.begin() + static_cast<ptrdiff_t>(near_begin_.back()), near_.end());
    near_begin_.push_back(near_.size());
  }
}

void BondList::name_ghosts() {
  outside_.clear();
  for (const Near& near : near_)
    if (near.image != std::array<int32_t, 3>{}) outside_.push_back(near);
  std::sort(outside_.begin(), outside_.end());
  outside_.erase(std::unique(outside_.begin(), outside_.end()), outside_.end());
  ghosts_.clear();
  for (const Near& near : outside_) ghosts_.push_back({near.atom, near.image});
}

uint32_t BondList::place_of(const Near& near) const {
  if (near.image == std::array<int32_t, 3>{}) return near.atom;
  const auto at = std::lower_bound(outside_.begin(), outside_.end(), near) - outside_.begin();
  return static_cast<uint32_t>(slots() + static_cast<size_t>(at));
}

void BondList::fill_rows() {
  const size_t n = reference_.size(), groups = (n + lanes_ - 1) / lanes_;
  const auto count = [&](size_t i) { return i < n ? near_begin_[i + 1] - near_begin_[i] : 0; };
  first_row_.assign(1, 0);
  most_rows_ = 0;
  for (size_t g = 0; g < groups; ++g) {
    size_t rows = 0;
    for (size_t lane = 0; lane < lanes_; ++lane) rows = std::max(rows, count(g * lanes_ + lane));
    most_rows_ = std::max(most_rows_, rows);
    first_row_.push_back(first_row_.back() + static_cast<uint32_t>(rows));
  }
  if (rows() * lanes_ > kMostPlaces || slots() + ghosts_.size() > kMostPlaces)
    throw std::runtime_error(
        fmt::format("{} atoms have {} rows of neighbours, more than a list holds", n, rows()));
  const auto slot = [&](size_t i, size_t k) { return (first_row_[i / lanes_] + k) * lanes_ + i % lanes_; };
  entry_.resize(rows() * lanes_), reverse_.resize(rows() * lanes_);
  for (size_t i = 0; i < slots(); ++i)
    for (size_t k = 0; first_row_[i / lanes_] + k < first_row_[i / lanes_ + 1]; ++k) {
      const size_t own = slot(i, k);
      entry_[own] = static_cast<uint32_t>(4 * i), reverse_[own] = static_cast<uint32_t>(4 * own);
      if (k >= count(i)) continue;
      const Near& near = near_[near_begin_[i] + k];
      const Near back{static_cast<uint32_t>(i), {-near.image[0], -near.image[1], -near.image[2]}};
      const auto begin = near_.begin() + static_cast<ptrdiff_t>(near_begin_[near.atom]),
                 end = near_.begin() + static_cast<ptrdiff_t>(near_begin_[near.atom + 1]);
      const auto seen = std::lower_bound(begin, end, back);
      // Rounding at the reach itself can leave one end without the other: such a pair is beyond the cutoff.
      if (seen == end || *seen != back) continue;
      entry_[own] = 4 * place_of(near);
      reverse_[own] = static_cast<uint32_t>(4 * slot(near.atom, static_cast<size_t>(seen - begin)));
    }
}

}  // namespace cuboct
