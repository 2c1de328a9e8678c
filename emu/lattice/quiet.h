// SPDX-License-Identifier: MIT
// Which cells need work: those in whose neighbourhood something changed in the step before.
//
// A step is a function of a particle and its neighbours; of several rounds, of their neighbours too. Where
// none of them changed a bit, the step changes nothing again, so it need not be taken: exact in integers.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/lattice/kernel.h"
#include "emu/lattice/ranks.h"
#include "emu/lattice/search.h"

namespace cuboct::emu {

// A set of cells, dense, that knows which rows hold any.
class CellSet {
 public:
  CellSet() = default;
  CellSet(const Lattice& lattice, const Rows& rows) : flag_(lattice.size() + 8), row_(rows.count()) {}
  const uint8_t* flags() const { return flag_.data(); }
  uint8_t* flags() { return flag_.data(); }

  // By cell, readable 8 bytes beyond.
  // Looks at flags() again after others have written there.
  void survey(const Rows& rows);
  void clear(const Rows& rows);
  void add(const CellSet& other, const Rows& rows);
  uint64_t count(const Rows& rows) const;
  // This becomes `other` and all its neighbours (26 each).
  void dilate(const CellSet& other, const Lattice& lattice, const Rows& rows);
  template <typename See>
  void for_each(const Rows& rows, const See& see) const {
    for (uint32_t r = 0; r < row_.size(); ++r)
      if (row_[r] != 0)
        for (uint32_t n = rows.row(r).begin; n < rows.row(r).end; ++n)
          if (flag_[n] != 0) see(n);
  }

 private:
  void spread_x(const CellSet& other, const Lattice& lattice, const Rows& rows);
  void spread_rows(const CellSet& other, int dy, int dz, const Lattice& lattice, const Rows& rows);
  std::vector<uint8_t> flag_, row_;
};

class Quiet {
 public:
  Quiet() = default;
  // `rounds` of a step: through so many cells a change is seen in one.
  Quiet(const Lattice& lattice, const Rows& rows, int rounds = 1);

  // What the next step has to look at; valid until the next call.
  Active next();
  // Cells at rest in the step that next() began, as far as they were told apart.
  uint64_t quiet_cells() const { return quiet_cells_; }

  // Where the step that next() began tells by cell what changed, if Active::changed is set.
  void changed(uint32_t cell) { changed_.flags()[cell] = 1; }
  // The step is over, on all ranks (null: there is one).
  void done(Ranks* ranks);

  // Cells within kHops of one that changed since the last call; null: all. Valid until the next call.
  static constexpr int kHops = 3;
  const uint8_t* take_touched();
  // Cells in which something changed since forget_moved(); null: all.
  const CellSet* moved() const { return moved_all_ ? nullptr : &moved_; }
  void forget_moved();

 private:
  const Lattice* lattice_ = nullptr;
  const Rows* rows_ = nullptr;
  int rounds_ = 1;
  bool told_ = false;     // the changes of the step before are known
  bool telling_ = false;  // those of this step will be
  int pause_ = 0;         // steps for which nothing is told apart
  uint64_t quiet_cells_ = 0;
  bool touched_all_ = true, moved_all_ = true;
  CellSet changed_, awake_, near_, touched_, moved_, spare_;
};

}  // namespace cuboct::emu
