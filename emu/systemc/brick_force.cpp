// SPDX-License-Identifier: MIT
#include "emu/systemc/brick_force.h"

#include <algorithm>
#include <bit>

#include "emu/systemc/planar.h"

namespace cuboct::emu {

struct BrickForce::Stream : ForceStream {
  // An item: one candidate before one pass of a cell's slots, or, with a mask of nothing, a visit at which
  // nobody met.
  struct Item {
    uint32_t candidate, own, pass;
  };
  std::vector<Candidate> candidate;  // in the frame of the own cell
  std::vector<Item> item;
  PlanarSlots own;
  std::array<uint64_t, kForceSegments> idle{};  // items at which nobody met
};

// The candidates of one cell before the slots of another.
void BrickForce::present(Stream& stream, uint32_t own, const BrickWalk::Near& near) const {
  const auto local = static_cast<size_t>(near.local);
  const size_t count = near.local >= 0 ? cells_.own[local].size() : cells_.halo[near.grid].size();
  const size_t slots = cells_.own[own].size(), passes = (slots + lanes_ - 1) / lanes_;
  const bool same = near.offset == std::array<int8_t, 3>{};
  const uint64_t lane_mask = ~uint64_t{0} >> (64 - lanes_);
  const PlanarTest test(plan_.rule);
  for (size_t k = 0; k < count; ++k) {
    Candidate c = near.local >= 0 ? cells_.own[local][k].body : cells_.halo[near.grid][k];
    for (size_t a = 0; a < 3; ++a)
      c.x[a] = static_cast<int32_t>(c.x[a] + (int64_t{near.offset[a]} << plan_.rule.widths.position_frac));
    PlanarMask met = test(stream.own, c.x);
    if (same) met.clear(static_cast<uint32_t>(k));
    for (size_t p = 0; p < passes; ++p) {
      stream.mask.push_back(met.from(static_cast<uint32_t>(p * lanes_)) & lane_mask);
      stream.item.push_back({static_cast<uint32_t>(stream.candidate.size()), own, static_cast<uint32_t>(p)});
    }
    stream.candidate.push_back(c);
  }
}

void BrickForce::filter(Stream& stream) const {
  stream.mask.clear();
  stream.candidate.clear();
  stream.item.clear();
  stream.idle = {};
  const PlanarTest test(plan_.rule);
  const auto nobody = [&](size_t segment) {
    stream.mask.push_back(0);
    stream.item.push_back({});
    ++stream.idle[segment];
  };
  for (size_t segment = 0; segment < walk_.visits.size(); ++segment) {
    for (const BrickWalk::Visit& visit : walk_.visits[segment]) {
      const std::vector<Slot>& slots = cells_.own[visit.own];
      if (slots.empty()) {
        nobody(segment);
        continue;
      }
      stream.own.clear();
      for (const Slot& s : slots) stream.own.add(s.body.x, test.shift());
      for (uint32_t k = visit.first; k < visit.end; ++k) {
        const size_t before = stream.item.size();
        present(stream, visit.own, walk_.near[k]);
        if (stream.item.size() == before) nobody(segment);
      }
    }
    stream.segment_end[segment] = static_cast<uint32_t>(stream.item.size());
  }
}

void BrickForce::issue(const Stream& stream, uint32_t entry, uint64_t& mask) {
  const Stream::Item& item = stream.item[entry];
  const Candidate& other = stream.candidate[item.candidate];
  for (int pipe = 0; pipe < plan_.arch.force_pipes && mask != 0; ++pipe) {
    const size_t slot = item.pass * lanes_ + static_cast<size_t>(std::countr_zero(mask));
    mask &= mask - 1;
    meet(cells_.own[item.own][slot], item.own, slot, other);
  }
}

uint64_t BrickForce::run() {
  static thread_local Stream stream;
  filter(stream);
  const uint64_t last = clock_force(plan_, stream, segments_, available_, pipe(), counts_,
                                    [&](uint32_t entry, uint64_t& mask) { issue(stream, entry, mask); });
  for (size_t segment = 0; segment < static_cast<size_t>(segments_); ++segment) {
    counts_.candidates -= stream.idle[segment];
    if (segment == 0) continue;
    counts_.by_axis[(segment - 1) / 2] +=
        stream.segment_end[segment] - stream.segment_end[segment - 1] - stream.idle[segment];
  }
  return last;
}

}  // namespace cuboct::emu
