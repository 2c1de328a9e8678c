// SPDX-License-Identifier: MIT
// Which atoms are near which: the list that bond-order forces run over. It holds as long as no pair that it
// lacks can have come within the cutoff, in a box that may deform.
//
// Atoms stand in groups of as many as a vector has lanes; a group's rows hold one neighbour per atom each, by
// ascending atom and image. A neighbour in another image of the box is a ghost: a copy behind the atoms,
// which whoever computes refreshes from its owner. So no image is looked for within the loops, and a box may
// be shorter than a cutoff.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "model/atoms/bond_order/atom_box.h"

namespace cuboct {

class BondList {
 public:
  // `cutoff` as of the potential; pairs within cutoff + skin are listed. `lanes`: of a vector (bond_lanes()).
  BondList(double cutoff, double skin, size_t lanes);

  // Makes the list anew where it does not hold at these positions. True where it was made. Positions need not
  // be wrapped. std::runtime_error, naming the atom, where one is not finite or two coincide.
  bool update(const AtomBox& box, std::span<const Vec3> x);
  bool holds(const AtomBox& box, std::span<const Vec3> x) const;

  struct Ghost {
    uint32_t owner;
    std::array<int32_t, 3> image;  // it stands at x[owner] + edges * image
  };

  size_t atoms() const { return reference_.size(); }
  size_t lanes() const { return lanes_; }
  size_t groups() const { return first_row_.size() - 1; }
  size_t slots() const { return groups() * lanes_; }  // where the ghosts begin
  size_t rows() const { return first_row_.back(); }
  size_t most_rows() const { return most_rows_; }  // of a group
  std::span<const Ghost> ghosts() const { return ghosts_; }
  std::span<const uint32_t> first_row() const { return first_row_; }  // of each group, and the end
  // [row * lanes + lane]: 4 times the place of the neighbour, atom or ghost; an atom's own where it has no
  // more.
  std::span<const uint32_t> entry() const { return entry_; }
  // 4 times the entry that holds this bond seen from its other end; its own where the entry is empty.
  std::span<const uint32_t> reverse() const { return reverse_; }
  uint64_t made() const { return made_; }

 private:
  struct Near {
    uint32_t atom;
    std::array<int32_t, 3> image;
    auto operator<=>(const Near&) const = default;
  };
  void make(const AtomBox& box, std::span<const Vec3> x);
  void sort_into_cells(const AtomBox& box, std::span<const Vec3> x);
  void find_near(const AtomBox& box);
  void name_ghosts();
  void fill_rows();
  uint32_t place_of(const Near& near) const;

  double cutoff_, skin_;
  size_t lanes_, most_rows_ = 0;
  uint64_t made_ = 0;
  bool valid_ = false;
  AtomBox box_;                  // of the last make
  std::vector<Vec3> reference_;  // positions of the last make
  std::vector<uint32_t> first_row_{0}, entry_, reverse_;
  std::vector<Ghost> ghosts_;

  // While it is made: wrapped positions and images, the cells, and each atom's neighbours.
  std::vector<Vec3> wrapped_;
  std::vector<std::array<int32_t, 3>> image_, cell_;
  std::array<int32_t, 3> cells_{1, 1, 1}, around_{};
  std::vector<uint32_t> cell_begin_, cell_atoms_;
  std::vector<size_t> near_begin_;
  std::vector<Near> near_, outside_;
};

}  // namespace cuboct
