// SPDX-License-Identifier: MIT
// Each particle's neighbours within a distance, of positions in real numbers: the walk of
// model/real/near_walk.h, in threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "model/base/parallel.h"
#include "model/contract/nearest_image.h"
#include "model/real/near_walk.h"

namespace cuboct {

// InputError where a period is below two of `range` (m): a particle would meet two images of another. `what`:
// "cutoff".
void check_range(double range, const Periodic& periodic, const char* what);

// Calls see(member, i, near) once for each particle i: `near` are the ids of all others nearer than `range`
// (m), ascending. Calls run in up to `threads` threads (0: one per core), of which `member` tells this one.
// In which order depends on their number.
template <class See>
void for_each_near(const std::vector<Vec3>& x, const Periodic& periodic, double range, int threads,
                   const See& see) {
  constexpr size_t kEach = 2000;  // particles
  CellList cells(range, periodic);
  cells.build(x);
  const std::span<const uint32_t> order = cells.order();
  const NearWalk walk(cells, x, periodic);
  const size_t parts = std::max<size_t>(1, x.size() / kEach);
  for_each_part(parts, threads > 0 ? threads : usable_cores(), [&](size_t part, int member) {
    std::vector<uint32_t> near;
    walk(range, x.size() * part / parts, x.size() * (part + 1) / parts,
         [&](size_t slot, std::span<const uint64_t> found) {
           const uint32_t i = order[slot];
           near.clear();
           for (const uint64_t one : found)
             if (const auto j = static_cast<uint32_t>(one >> 32); j != i) near.push_back(j);
           see(static_cast<size_t>(member), i, std::span<const uint32_t>(near));
         });
  });
}

}  // namespace cuboct
