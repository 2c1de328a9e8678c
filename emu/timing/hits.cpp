// SPDX-License-Identifier: MIT
#include "emu/timing/hits.h"

#include <algorithm>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "emu/timing/hits.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::emu::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<int32_t>;
using V = hn::Vec<D>;

// The candidates of `node` in the order of its streamer. A halo holds what the face's neighbour holds and,
// for y and z, what it got along the axes before, in its own order: three nested walks of (here, below,
// above). Returns how many, and by segment.
size_t gather(const PlanarBounds& test, const Places& places, uint32_t node, HitScratch& scratch,
              std::array<uint32_t, kSegments>& records) {
  const D d;
  const size_t step = hn::Lanes(d);
  const V zero = hn::Zero(d), cell = hn::Set(d, int32_t{1} << test.position_frac);
  const V shift[3] = {zero, hn::Sub(zero, cell), cell};
  // x + shift lies in [-2^P, 2^(P+1)).
  const auto coarse = [&](const int32_t* x, V by)
                          HWY_ATTR { return hn::ShiftRightSame(hn::Add(hn::LoadU(d, x), by), test.shift); };
  int32_t* const to[3] = {scratch.x[0].data(), scratch.x[1].data(), scratch.x[2].data()};
  const auto near = [&](uint32_t of, size_t axis, size_t way) {
    return way == 0 ? of : places.neighbour[of][2 * axis + way - 1];
  };
  records = {};
  size_t count = 0;
  for (size_t wz = 0; wz < test.layers; ++wz) {
    const uint32_t at_z = near(node, 2, wz);
    for (size_t wy = 0; wy < 3; ++wy) {
      const uint32_t at_y = near(at_z, 1, wy);
      for (size_t wx = 0; wx < 3; ++wx) {
        const uint32_t at = near(at_y, 0, wx);
        const uint32_t first = places.first[at], size = places.first[at + 1] - first;
        // Whole vectors: what lies beyond `size` is overwritten by what follows.
        for (size_t k = 0; k < size; k += step) {
          hn::StoreU(coarse(places.x[0] + first + k, shift[wx]), d, to[0] + count + k);
          hn::StoreU(coarse(places.x[1] + first + k, shift[wy]), d, to[1] + count + k);
          hn::StoreU(coarse(places.x[2] + first + k, shift[wz]), d, to[2] + count + k);
        }
        count += size;
        records[wz != 0 ? 4 + wz : wy != 0 ? 2 + wy : wx] += size;
      }
    }
  }
  return count;
}

// hits[k] = own particles that candidate k meets, of slots [from, to) of `node`.
void count(const PlanarBounds& test, const Places& places, uint32_t node, uint32_t from, uint32_t to,
           const HitScratch& scratch, size_t candidates, uint8_t* hits) {
  const D d;
  const hn::Rebind<uint8_t, D> bytes;
  const int shift = test.shift;
  const V one = hn::Set(d, test.planar[0]), two = hn::Set(d, test.planar[1]),
          three = hn::Set(d, test.planar[2]);
  const auto size = [&](V candidate, int32_t own) HWY_ATTR {
    const V e = hn::Sub(candidate, hn::Set(d, own >> shift));
    return hn::Xor(e, hn::ShiftRight<31>(e));
  };
  const uint32_t first = places.first[node];
  const int32_t* const x_i = places.x[0] + first;
  const int32_t* const y_i = places.x[1] + first;
  const int32_t* const z_i = places.x[2] + first;
  for (size_t k = 0; k < candidates; k += hn::Lanes(d)) {
    const V x_j = hn::LoadU(d, scratch.x[0].data() + k), y_j = hn::LoadU(d, scratch.x[1].data() + k),
            z_j = hn::LoadU(d, scratch.x[2].data() + k);
    V sum = hn::Set(d, static_cast<int32_t>(to - from));
    for (uint32_t i = from; i < to; ++i) {
      const V x = size(x_j, x_i[i]), y = size(y_j, y_i[i]), z = size(z_j, z_i[i]);
      const V all = hn::Add(hn::Add(x, y), z);
      const V most = hn::Max(hn::Max(x, y), z), pair = hn::Sub(all, hn::Min(hn::Min(x, y), z));
      const V room = hn::Min(hn::Min(hn::Sub(one, most), hn::Sub(two, pair)), hn::Sub(three, all));
      sum = hn::Add(sum, hn::ShiftRight<31>(room));  // -1 where a test fails
    }
    if (k < to) {  // the candidate itself
      const V slot = hn::Iota(d, static_cast<int32_t>(k));
      const auto self = hn::AndNot(hn::Lt(slot, hn::Set(d, static_cast<int32_t>(from))),
                                   hn::Lt(slot, hn::Set(d, static_cast<int32_t>(to))));
      sum = hn::Add(sum, hn::VecFromMask(d, self));
    }
    hn::StoreU(hn::DemoteTo(bytes, sum), bytes, hits + k);
  }
}

// Items are records, and in each its passes.
const uint8_t* by_item(HitScratch& scratch, size_t candidates, uint32_t passes) {
  const uint8_t* const hits = scratch.hits.data();
  if (passes == 1) return hits;
  uint8_t* const items = scratch.items.data();
  if (passes == 2) {  // the compiler has vectors for this one
    const uint8_t* const second = hits + scratch.row;
    for (size_t k = 0; k < candidates; ++k) items[2 * k] = hits[k], items[2 * k + 1] = second[k];
    return items;
  }
  for (uint32_t pass = 0; pass < passes; ++pass)
    for (size_t k = 0; k < candidates; ++k) items[k * passes + pass] = hits[pass * scratch.row + k];
  return items;
}

// Entries of the items with hits, and the sum of hits.
std::pair<size_t, uint64_t> pack(const uint8_t* hits, size_t items, uint32_t pipes, uint32_t* entries) {
  const D d;
  const hn::Rebind<uint8_t, D> bytes;
  // ceil(h / F) = floor(h1 / F) with h1 = h + F - 1 < 128. With r = floor(2^16 / F) + 1, h1 r / 2^16 exceeds
  // h1 / F by at most h1 / 2^16 < 1 / F: no integer lies between.
  const V more = hn::Set(d, static_cast<int32_t>(pipes) - 1),
          reciprocal = hn::Set(d, 65536 / static_cast<int32_t>(pipes) + 1);
  V item = hn::Iota(d, 0);
  const V step = hn::Set(d, static_cast<int32_t>(hn::Lanes(d))),
          count = hn::Set(d, static_cast<int32_t>(items));
  auto* to = reinterpret_cast<int32_t*>(entries);
  size_t packed = 0;
  V pairs = hn::Zero(d);  // at most 27 * 256 * 256 hits
  for (size_t k = 0; k < items; k += hn::Lanes(d)) {
    const V h = hn::PromoteTo(d, hn::LoadU(bytes, hits + k));
    const V cycles = hn::ShiftRight<16>(hn::Mul(hn::Add(h, more), reciprocal));
    const auto hit = hn::And(hn::Gt(h, hn::Zero(d)), hn::Lt(item, count));
    pairs = hn::Add(pairs, hn::IfThenElseZero(hit, h));
    packed +=
        hn::CompressStore(hn::Or(hn::ShiftLeft<ForceWork::kCycleBits>(item), cycles), hit, d, to + packed);
    item = hn::Add(item, step);
  }
  return {packed, static_cast<uint64_t>(hn::GetLane(hn::SumOfLanes(d, pairs)))};
}

}  // namespace

ForceWork filter_node(const Filter& filter, const Places& places, uint32_t node, HitScratch& scratch) {
  ForceWork work;
  const uint32_t n = places.first[node + 1] - places.first[node];
  const size_t candidates = gather(filter.test, places, node, scratch, work.items);
  const uint32_t passes = (n + filter.lanes - 1) / filter.lanes;
  for (uint32_t pass = 0; pass < passes; ++pass) {
    const uint32_t from = pass * filter.lanes, to = std::min(n, from + filter.lanes);
    count(filter.test, places, node, from, to, scratch, candidates, scratch.hits.data() + pass * scratch.row);
  }
  for (uint32_t& items : work.items) items *= passes;
  const uint8_t* const items = by_item(scratch, candidates, passes);
  const auto [entries, pairs] = pack(items, candidates * passes, filter.pipes, scratch.entries.data());
  work.entries = {scratch.entries.data(), entries};
  work.pairs = pairs;
  return work;
}

}  // namespace cuboct::emu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct::emu {

HWY_EXPORT(filter_node);

PlanarBounds::PlanarBounds(const FixedRule& rule)
    : position_frac(rule.widths.position_frac),
      shift(rule.widths.position_frac - rule.widths.filter_frac),
      layers(rule.axes == 3 ? 3 : 1) {
  for (size_t k = 0; k < planar.size(); ++k) planar[k] = static_cast<int32_t>(rule.planar[k]);
}

Filter::Filter(const FixedRule& rule, int lanes_, int pipes_)
    : test(rule), lanes(static_cast<uint32_t>(lanes_)), pipes(static_cast<uint32_t>(pipes_)) {}

HitScratch::HitScratch(int capacity, int lanes) : row(27 * static_cast<size_t>(capacity) + Places::kBeyond) {
  const auto passes = static_cast<size_t>((capacity + lanes - 1) / lanes);
  for (auto& column : x) column.resize(row);
  hits.resize(row * passes);
  items.resize(row * passes);
  entries.resize(row * passes);
}

ForceWork filter_node(const Filter& filter, const Places& places, uint32_t node, HitScratch& scratch) {
  return HWY_DYNAMIC_DISPATCH(filter_node)(filter, places, node, scratch);
}

}  // namespace cuboct::emu
#endif
