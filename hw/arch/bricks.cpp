// SPDX-License-Identifier: MIT
#include "hw/arch/bricks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <map>
#include <tuple>

#include "hw/arch/cell_box.h"
#include "model/base/error.h"
#include "model/base/integer_math.h"

namespace cuboct {
namespace {

// The two axes of a layer across `axis`, the faster one first.
std::pair<int, int> across(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

// Calls see(cell) for all cells from `low` to `high`, both included, x first.
template <typename See>
void for_all(const Cell& low, const Cell& high, See see) {
  for (int32_t z = low[2]; z <= high[2]; ++z)
    for (int32_t y = low[1]; y <= high[1]; ++y)
      for (int32_t x = low[0]; x <= high[0]; ++x) see(Cell{x, y, z});
}

}  // namespace

// Along an axis before `axis` a layer reaches one cell beyond the brick at both ends.
uint32_t BrickGrid::halo_tag(int axis, const Cell& cell) const {
  const auto [u, v] = across(axis);
  const int32_t beyond_u = u < axis, beyond_v = v < axis;
  return static_cast<uint32_t>(cell[u] + beyond_u + (shape_[u] + 2 * beyond_u) * (cell[v] + beyond_v));
}

Cell BrickGrid::of_halo_tag(int axis, uint32_t tag, int32_t along) const {
  const auto [u, v] = across(axis);
  const int32_t beyond_u = u < axis, beyond_v = v < axis;
  const auto row = static_cast<uint32_t>(shape_[u] + 2 * beyond_u);
  Cell cell;
  cell[axis] = along;
  cell[u] = static_cast<int32_t>(tag % row) - beyond_u;
  cell[v] = static_cast<int32_t>(tag / row) - beyond_v;
  return cell;
}

uint32_t BrickGrid::halo_tags(int axis) const {
  const auto [u, v] = across(axis);
  return static_cast<uint32_t>((shape_[u] + 2 * (u < axis)) * (shape_[v] + 2 * (v < axis)));
}

uint32_t BrickGrid::migrate_tag(int axis, const Cell& cell) const {
  const auto [u, v] = across(axis);
  return static_cast<uint32_t>(cell[u] + shape_[u] * cell[v]);
}

Cell BrickGrid::of_migrate_tag(int axis, uint32_t tag, int32_t along) const {
  const auto [u, v] = across(axis);
  const auto row = static_cast<uint32_t>(shape_[u]);
  Cell cell;
  cell[axis] = along;
  cell[u] = static_cast<int32_t>(tag % row);
  cell[v] = static_cast<int32_t>(tag / row);
  return cell;
}

uint32_t BrickGrid::migrate_tags(int axis) const {
  const auto [u, v] = across(axis);
  return static_cast<uint32_t>(shape_[u] * shape_[v]);
}

BrickWalk::BrickWalk(const Cell& shape, const Cell& extent, uint8_t has_link, int axes) {
  const BrickGrid grid(shape);
  const Cell first{0, 0, 0}, last{extent[0] - 1, extent[1] - 1, extent[2] - 1};
  // The cells around that can hold anything: those beyond a face with a link.
  Cell low = first, high = last;
  for (int a = 0; a < axes; ++a) {
    low[a] -= has_link >> (2 * a) & 1;
    high[a] += has_link >> (2 * a + 1) & 1;
  }
  const auto local = [&](const Cell& cell) {
    for (int a = 0; a < 3; ++a)
      if (cell[a] < first[a] || cell[a] > last[a]) return -1;
    return static_cast<int32_t>(grid.local(cell));
  };
  for_all(first, last, [&](const Cell& cell) { own.push_back(grid.local(cell)); });
  for (int segment = 0; segment < 1 + 2 * axes; ++segment) {
    const int face = segment - 1, axis = segment == 0 ? 0 : face / 2;
    if (segment > 0 && (has_link >> face & 1) == 0) continue;
    // The segment's candidates lie in this box, its own cells in that one.
    Cell near_low = first, near_high = last, own_low = first, own_high = last;
    if (segment > 0) {
      for (int b = 0; b < axis; ++b) near_low[b] = low[b], near_high[b] = high[b];
      const bool up = face % 2 == 1;
      near_low[axis] = near_high[axis] = up ? extent[axis] : -1;
      own_low[axis] = own_high[axis] = up ? last[axis] : 0;
      for_all({near_low[0], near_low[1], near_low[2]}, near_high, [&](Cell cell) {
        cell[axis] = own_low[axis];
        sent[as_size(face)].push_back({grid.at(cell), grid.halo_tag(axis, cell), local(cell)});
      });
    }
    for_all(own_low, own_high, [&](const Cell& cell) {
      Visit visit{grid.local(cell), static_cast<uint32_t>(near.size()), 0};
      Cell from, to;
      for (int a = 0; a < 3; ++a) {
        from[a] = std::max(cell[a] - 1, near_low[a]);
        to[a] = std::min(cell[a] + 1, near_high[a]);
      }
      for_all(from, to, [&](const Cell& other) {
        Near n{grid.at(other), local(other), {}};
        for (int a = 0; a < 3; ++a) n.offset[as_size(a)] = static_cast<int8_t>(other[a] - cell[a]);
        near.push_back(n);
      });
      visit.end = static_cast<uint32_t>(near.size());
      visits[as_size(segment)].push_back(visit);
    });
  }
}

Bricks::Bricks(const Lattice& lattice, const Cell& shape) : shape_(shape) {
  if (lattice.size() == 0) return;
  if (cells() == 1) {
    nodes_ = lattice.size();
    return;
  }
  const auto box = box_of(lattice, true);
  const Cell &low = box.low, &high = box.high;
  Cell length, largest;
  for (int a = 0; a < 3; ++a) {
    length[a] = high[a] - low[a] + 1;
    largest[a] = std::min(shape[a], length[a]);
  }
  for (int a = 0; a < 3; ++a)
    if (shape[a] > length[a])
      throw InputError(
          fmt::format("brick = [{}] is larger than the lattice: it has {} cell{} along {}",
                      fmt::join(shape, ", "), length[a], length[a] == 1 ? "" : "s", "xyz"[a]),
          fmt::format("set node.brick to at most [{}] in the arch file", fmt::join(largest, ", ")))
          .about({"node.brick"});

  const BrickGrid grid(shape);
  std::map<std::tuple<int32_t, int32_t, int32_t>, std::vector<uint32_t>> bricks;  // cells by (z, y, x)
  const auto brick_of = [&](uint32_t cell, int a) { return (lattice.cell(cell)[a] - low[a]) / shape[a]; };
  for (uint32_t c = 0; c < lattice.size(); ++c)
    bricks[{brick_of(c, 2), brick_of(c, 1), brick_of(c, 0)}].push_back(c);
  place_.resize(lattice.size());
  cells_.assign(bricks.size() * this->cells(), kNoCell);
  for (const auto& [key, cells] : bricks) {
    Box box;
    box.neighbour.fill(kNoNode);
    const Cell brick{std::get<2>(key), std::get<1>(key), std::get<0>(key)};
    for (int a = 0; a < 3; ++a) {
      box.low[a] = low[a] + brick[a] * shape[a];
      box.extent[a] = std::min(shape[a], high[a] + 1 - box.low[a]);
    }
    for (const uint32_t c : cells) {
      Cell inside = lattice.cell(c);
      for (int a = 0; a < 3; ++a) inside[a] -= box.low[a];
      place_[c] = nodes_ * this->cells() + grid.local(inside);
      cells_[place_[c]] = c;
    }
    box_.push_back(box);
    ++nodes_;
  }
  for (uint32_t c = 0; c < lattice.size(); ++c) {
    Box& box = box_[node_of(c)];
    for (int a = 0; a < 3; ++a) {
      const int32_t inside = lattice.cell(c)[a] - box.low[a];
      for (int up = 0; up < 2; ++up) {
        const uint32_t other = lattice.neighbour(c, 2 * a + up);
        if (other != kNoCell && inside == (up != 0 ? box.extent[a] - 1 : 0))
          box.neighbour[as_size(2 * a + up)] = node_of(other);
      }
    }
  }
}

int Bricks::cell_bits() const { return static_cast<int>(std::bit_width(cells() - 1)); }

uint8_t Bricks::links(const Lattice& lattice, uint32_t node) const {
  uint8_t faces = 0;
  for (int f = 0; f < kFaces; ++f)
    if (neighbour(lattice, node, f) != kNoNode) faces |= static_cast<uint8_t>(1u << f);
  return faces;
}

HeldWords held_words(const Cell& brick, int axes) {
  const BrickGrid grid(brick);
  HeldWords held;
  held.sums = cells_of(brick);
  held.particles = held.sums > 1 ? 2 * held.sums : 1;
  for (int a = 0; a < axes; ++a) {
    held.particles += 2 * grid.migrate_tags(a);
    held.halos += 2 * grid.halo_tags(a);
  }
  return held;
}

BrickMap::BrickMap(const Lattice& lattice, const Bricks& bricks, int axes) : grid_(bricks.shape()) {
  using Key = std::tuple<int32_t, int32_t, int32_t, uint8_t>;
  std::map<Key, std::shared_ptr<const BrickWalk>> walks;
  const Cell& shape = bricks.shape();
  cell_.assign(size_t{bricks.size()} * grid_.size(), kNoCell);
  const auto place = [this](uint32_t node, uint32_t grid) -> uint32_t& {
    return cell_[size_t{node} * grid_.size() + grid];
  };
  for (uint32_t n = 0; n < bricks.size(); ++n) {
    const Cell extent = bricks.extent(n);
    const uint8_t links = bricks.links(lattice, n);
    auto& walk = walks[{extent[0], extent[1], extent[2], links}];
    if (!walk) walk = std::make_shared<const BrickWalk>(shape, extent, links, axes);
    walk_.push_back(walk);
    for_all({0, 0, 0}, {extent[0] - 1, extent[1] - 1, extent[2] - 1},
            [&](const Cell& index) { place(n, grid_.at(index)) = bricks.cell(n, grid_.local(index)); });
  }
  // As the records go: an axis forwards what came along those before it.
  for (int axis = 0; axis < axes; ++axis)
    for (uint32_t n = 0; n < bricks.size(); ++n)
      for (int face = 2 * axis; face < 2 * axis + 2; ++face) {
        const uint32_t to = bricks.neighbour(lattice, n, face);
        if (to == kNoNode) continue;
        const int32_t along = face % 2 == 1 ? -1 : bricks.extent(to)[axis];
        for (const BrickWalk::Sent& s : walk_[n]->sent[as_size(face)])
          place(to, grid_.at(grid_.of_halo_tag(axis, s.tag, along))) = place(n, s.grid);
      }
}

}  // namespace cuboct
