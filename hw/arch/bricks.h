// SPDX-License-Identifier: MIT
// Bricks: the cells that one physical node serves in turn, and the orders in which it walks them.
// docs/reference/node.md, "Bricks".
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "model/contract/lattice.h"

namespace cuboct {

// No node of the machine.
inline constexpr uint32_t kNoNode = kNoCell;

// The largest brick, in cells.
inline constexpr int kMostBrickCells = 512;

inline uint32_t cells_of(const Cell& brick) {
  return static_cast<uint32_t>(brick[0]) * static_cast<uint32_t>(brick[1]) * static_cast<uint32_t>(brick[2]);
}

// Numbers of the cells of a brick and around it; coordinates are -1 ... shape[a], the brick's own ones those
// in [0, shape[a]).
class BrickGrid {
 public:
  explicit BrickGrid(const Cell& shape) : shape_(shape) {}
  // Own cells, x first.
  uint32_t local(const Cell& at) const { return number(at, shape_); }
  uint32_t size() const { return cells_of({shape_[0] + 2, shape_[1] + 2, shape_[2] + 2}); }
  uint32_t at(const Cell& at) const {
    return number({at[0] + 1, at[1] + 1, at[2] + 1}, {shape_[0] + 2, shape_[1] + 2, shape_[2] + 2});
  }
  // What a halo record says of its cell: the number in the layer that goes over the axis. A layer along y has
  // the cells -1 ... shape[0] along x, one along z those along x and y.
  uint32_t halo_tag(int axis, const Cell& at) const;
  Cell of_halo_tag(int axis, uint32_t tag, int32_t along) const;
  uint32_t halo_tags(int axis) const;
  // What a particle on a link says of the cell that it goes to: the number in the brick's face.
  uint32_t migrate_tag(int axis, const Cell& at) const;
  Cell of_migrate_tag(int axis, uint32_t tag, int32_t along) const;
  uint32_t migrate_tags(int axis) const;

 private:
  static uint32_t number(const Cell& at, const Cell& size) {
    return static_cast<uint32_t>(at[0] + size[0] * (at[1] + size[1] * at[2]));
  }
  Cell shape_;
};

// How a node with these extents (<= shape) and links walks its cells. Absent cells are walked as empty ones.
struct BrickWalk {
  // A cell of the layer that goes over a face.
  struct Sent {
    uint32_t grid, tag;
    int32_t local;  // -1: of the halo
  };
  // A cell whose particles are candidates, and where it lies beside the own one.
  struct Near {
    uint32_t grid;
    int32_t local;  // -1: of the halo
    std::array<int8_t, 3> offset;
  };
  // An own cell, and its candidates of one segment: near[first ... end).
  struct Visit {
    uint32_t own, first, end;
  };

  BrickWalk(const Cell& shape, const Cell& extent, uint8_t has_link, int axes);

  std::vector<uint32_t> own;  // cells in order
  std::array<std::vector<Sent>, kFaces> sent;
  std::array<std::vector<Visit>, 1 + kFaces> visits;  // by segment: within the brick, then by face
  std::vector<Near> near;
};

// Which cells each node of the machine serves: the lattice, cut into bricks of one shape. A brick of one cell
// is one like any other; then a node has its cell's number, and nothing is stored. Else 48 bytes per node and
// 4 for each cell of its brick, and 4 for each of the lattice's cells.
class Bricks {
 public:
  Bricks() = default;
  // Cuts the lattice into bricks, from its lowest cell on. Throws InputError where `shape` does not fit.
  Bricks(const Lattice& lattice, const Cell& shape);

  const Cell& shape() const { return shape_; }
  uint32_t cells() const { return cells_of(shape_); }  // of a brick
  // A node of one cell has a core of its own (rtl/lib/node/cuboct_node_core.sv, emu/systemc/node.h), with
  // other phases than that of bricks. Only for what chooses a core, or knows its schedule.
  bool one_cell() const { return cells() == 1; }
  int cell_bits() const;                    // of a cell's number in its node; 0 if that is the only one
  uint32_t size() const { return nodes_; }  // nodes
  // The lattice's cell, or kNoCell where it has none there.
  uint32_t cell(uint32_t node, uint32_t local) const {
    return cells_.empty() ? node : cells_[node * cells() + local];
  }
  uint32_t node_of(uint32_t cell) const { return place_.empty() ? cell : place_[cell] / cells(); }
  uint32_t local_of(uint32_t cell) const { return place_.empty() ? 0 : place_[cell] % cells(); }
  // Cells along the axes: those of the shape, fewer at the upper end of the lattice.
  Cell extent(uint32_t node) const { return box_.empty() ? shape_ : box_[node].extent; }
  // What follows is of the lattice that was cut.
  // A node's lowest cell; the lattice may lack it.
  Cell low(const Lattice& lattice, uint32_t node) const {
    return box_.empty() ? lattice.cell(node) : box_[node].low;
  }
  // kNoNode where there is none over the face; itself where it closes a ring.
  uint32_t neighbour(const Lattice& lattice, uint32_t node, int face) const {
    return box_.empty() ? lattice.neighbour(node, face) : box_[node].neighbour[static_cast<size_t>(face)];
  }
  uint8_t links(const Lattice& lattice, uint32_t node) const;  // bit f: there is a neighbour over face f

 private:
  struct Box {
    Cell low, extent;
    std::array<uint32_t, kFaces> neighbour;
  };
  Cell shape_{1, 1, 1};
  uint32_t nodes_ = 0;
  // Empty where a brick is one cell.
  std::vector<Box> box_;         // [node]
  std::vector<uint32_t> cells_;  // [node][local]
  std::vector<uint32_t> place_;  // [cell]: node * cells() + local
};

// What a node's memories hold, in units of its capacity. A node of one cell: 7 particles (own slots and six
// inboxes), 26 halo records, one sum per pipe.
struct HeldWords {
  uint32_t particles = 0;  // own slots, those between cells of the brick, inboxes of the faces
  uint32_t halos = 0;      // records of the cells around
  uint32_t sums = 0;       // of each pipe
};
HeldWords held_words(const Cell& brick, int axes);

// The walks of all nodes, and which cell of the lattice stands where in their halos.
class BrickMap {
 public:
  // 4 bytes for each cell in and around a node's brick: 108 per node of one cell.
  BrickMap(const Lattice& lattice, const Bricks& bricks, int axes);
  const BrickGrid& grid() const { return grid_; }
  const BrickWalk& walk(uint32_t node) const { return *walk_[node]; }
  // The cell whose records the node holds at a place of its grid after the exchange, or kNoCell.
  uint32_t cell(uint32_t node, uint32_t place) const { return cell_[size_t{node} * grid_.size() + place]; }

 private:
  BrickGrid grid_;
  std::vector<std::shared_ptr<const BrickWalk>> walk_;  // shared by nodes of the same extent and links
  std::vector<uint32_t> cell_;
};

}  // namespace cuboct
