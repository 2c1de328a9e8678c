// SPDX-License-Identifier: MIT
// Boxes of cells.
#pragma once
#include <algorithm>

#include "model/contract/lattice.h"

namespace cuboct {

// A box of cells, both ends within; without any, `high` lies below `low`.
struct CellBox {
  Cell low{INT32_MAX, INT32_MAX, INT32_MAX}, high{INT32_MIN, INT32_MIN, INT32_MIN};
  void add(const Cell& cell) {
    for (size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], cell[a]), high[a] = std::max(high[a], cell[a]);
  }
  int64_t extent(size_t axis) const { return int64_t{high[axis]} - low[axis] + 1; }
};

// Around all cells; `rings`: along axes that repeat the whole ring.
inline CellBox box_of(const Lattice& lattice, bool rings) {
  CellBox box;
  for (uint32_t n = 0; n < lattice.size(); ++n) box.add(lattice.cell(n));
  for (size_t a = 0; a < 3; ++a)
    if (rings && lattice.period()[a] > 0) box.low[a] = 0, box.high[a] = lattice.period()[a] - 1;
  return box;
}

}  // namespace cuboct
