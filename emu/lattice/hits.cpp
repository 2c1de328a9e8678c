// SPDX-License-Identifier: MIT
#include "emu/lattice/hits.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "emu/lattice/hits.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::emu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<int32_t>;
using V = hn::Vec<D>;

// The candidates of `node` in the order of its streamer. A halo holds what the face's neighbour holds and, for y
// and z, what it got along the axes before, in its own order: three nested walks of (here, below, above).
// Returns how many, and by segment.
HWY_ATTR size_t gather(const PlanarTest& test, const Places& places, uint32_t node, HitScratch& scratch,
                       std::array<int, kSegments>& records) {
  const D d;
  const size_t step = hn::Lanes(d);
  const V zero = hn::Zero(d), cell = hn::Set(d, int32_t{1} << test.position_frac);
  const V shift[3] = {zero, hn::Sub(zero, cell), cell};
  const auto near = [&](uint32_t of, int axis, int way) {
    return way == 0 ? of : places.neighbour[of][static_cast<size_t>(2 * axis + way - 1)];
  };
  size_t count = 0;
  for (int wz = 0; wz < 3; ++wz) {
    const uint32_t at_z = near(node, 2, wz);
    for (int wy = 0; wy < 3; ++wy) {
      const uint32_t at_y = near(at_z, 1, wy);
      for (int wx = 0; wx < 3; ++wx) {
        const uint32_t at = near(at_y, 0, wx);
        const uint32_t first = places.first[at], size = places.first[at + 1] - first;
        // Whole vectors: what is beyond `size` is overwritten by the next node's or never read.
        for (size_t k = 0; k < size; k += step) {
          hn::StoreU(hn::Add(hn::LoadU(d, places.x[0] + first + k), shift[wx]), d,
                     scratch.x[0].data() + count + k);
          hn::StoreU(hn::Add(hn::LoadU(d, places.x[1] + first + k), shift[wy]), d,
                     scratch.x[1].data() + count + k);
          hn::StoreU(hn::Add(hn::LoadU(d, places.x[2] + first + k), shift[wz]), d,
                     scratch.x[2].data() + count + k);
        }
        count += size;
        const int segment = wz != 0 ? 4 + wz : wy != 0 ? 2 + wy : wx;
        records[static_cast<size_t>(segment)] += static_cast<int>(size);
      }
    }
  }
  return count;
}

// |difference|: round_odd is odd, so that the sign can go first.
HWY_INLINE HWY_ATTR V distance(V candidate, V own, V half, int shift) {
  const hn::RebindToUnsigned<D> u;
  const auto away = hn::BitCast(u, hn::Abs(hn::Sub(candidate, own)));
  return hn::BitCast(D(), hn::ShiftRightSame(hn::Add(away, hn::BitCast(u, half)), shift));
}

// hits[k] = own particles [first, last) that candidate k meets, itself included.
HWY_ATTR void count(const PlanarTest& test, const Places& places, uint32_t first, uint32_t last,
                    const HitScratch& scratch, size_t candidates, uint8_t* hits) {
  const D d;
  const hn::Rebind<uint8_t, D> bytes;
  const size_t step = hn::Lanes(d);
  const V half = hn::Set(d, test.shift == 0 ? 0 : int32_t{1} << (test.shift - 1));
  const V one = hn::Set(d, test.planar[0]), two = hn::Set(d, test.planar[1]),
          three = hn::Set(d, test.planar[2]);
  for (size_t k = 0; k < candidates; k += step) {
    const V cx = hn::LoadU(d, scratch.x[0].data() + k), cy = hn::LoadU(d, scratch.x[1].data() + k),
            cz = hn::LoadU(d, scratch.x[2].data() + k);
    V sum = hn::Set(d, static_cast<int32_t>(last - first));
    for (uint32_t i = first; i < last; ++i) {
      const V x = distance(cx, hn::Set(d, places.x[0][i]), half, test.shift);
      const V y = distance(cy, hn::Set(d, places.x[1][i]), half, test.shift);
      const V z = distance(cz, hn::Set(d, places.x[2][i]), half, test.shift);
      const V xy = hn::Add(x, y);
      const V most = hn::Max(hn::Max(x, y), z);
      const V pair = hn::Max(hn::Max(xy, hn::Add(y, z)), hn::Add(z, x));
      const V room = hn::Min(hn::Min(hn::Sub(one, most), hn::Sub(two, pair)), hn::Sub(three, hn::Add(xy, z)));
      sum = hn::Add(sum, hn::ShiftRight<31>(room));  // -1 where a test fails
    }
    hn::StoreU(hn::DemoteTo(bytes, sum), bytes, hits + k);
  }
}

HWY_ATTR ForceWork filter_node(const Filter& filter, const Places& places, uint32_t node,
                               HitScratch& scratch) {
  ForceWork work;
  const uint32_t first = places.first[node], n = places.first[node + 1] - first;
  const size_t candidates = gather(filter.test, places, node, scratch, work.items);
  const auto lanes = static_cast<uint32_t>(filter.lanes);
  const uint32_t passes = (n + lanes - 1) / lanes;
  for (uint32_t pass = 0; pass < passes; ++pass) {
    const uint32_t from = pass * lanes, to = std::min(n, from + lanes);
    uint8_t* const hits = scratch.hits.data();
    count(filter.test, places, first + from, first + to, scratch, candidates, hits);
    for (uint32_t slot = from; slot < to; ++slot) --hits[slot];  // the candidate itself
    for (size_t k = 0; k < candidates; ++k) scratch.service[k * passes + pass] = filter.service[hits[k]];
  }
  for (int& items : work.items) items *= static_cast<int>(passes);
  work.service = scratch.service.data();
  return work;
}

}  // namespace cuboct::emu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct::emu {

HWY_EXPORT(filter_node);

PlanarTest::PlanarTest(const FixedRule& rule)
    : position_frac(rule.widths.position_frac), shift(rule.difference_shift) {
  for (size_t k = 0; k < planar.size(); ++k) planar[k] = static_cast<int32_t>(rule.planar[k]);
}

ForceWork filter_node(const Filter& filter, const Places& places, uint32_t node, HitScratch& scratch) {
  return HWY_DYNAMIC_DISPATCH(filter_node)(filter, places, node, scratch);
}

}  // namespace cuboct::emu
#endif
