// SPDX-License-Identifier: MIT
#include "emu/systemc/force_engine.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "emu/systemc/planar.h"

namespace cuboct::emu {

// An entry is a (record, pass).
struct ForceEngine::Stream : ForceStream {
  std::vector<const Candidate*> record;  // of all segments
  uint32_t passes = 1;
  PlanarSlots own;
};

ForceEngine::ForceEngine(const Plan& plan, const std::vector<Slot>& own,
                         const std::array<std::vector<Candidate>, kFaces>& halo, FaultKeeper& fault)
    : ForceMachine(plan, 1, fault), own_(own), halo_(halo) {}

// Lists the records and tests each against all own slots.
void ForceEngine::filter(Stream& stream) const {
  const uint32_t n = static_cast<uint32_t>(own_.size());
  stream.record.clear();
  stream.mask.clear();
  stream.passes = (n + lanes_ - 1) / lanes_;
  stream.own.clear();
  const PlanarTest test(plan_.rule);
  for (const Slot& s : own_) stream.own.add(s.body.x, test.shift());
  const uint64_t lane_mask = ~uint64_t{0} >> (64 - lanes_);
  for (int segment = 0; segment < segments_; ++segment) {
    const auto one = [&](const Candidate& c, uint32_t self) {
      stream.record.push_back(&c);
      PlanarMask met = test(stream.own, c.x);
      if (self < n) met.clear(self);
      for (uint32_t p = 0; p < stream.passes; ++p) stream.mask.push_back(met.from(p * lanes_) & lane_mask);
    };
    if (segment > 0)
      for (const Candidate& c : halo_[segment - 1]) one(c, n);
    else
      for (uint32_t k = 0; k < n; ++k) one(own_[k].body, k);
    stream.segment_end[segment] = static_cast<uint32_t>(stream.mask.size());
  }
}

// Issues the lowest bits of `mask`, one per pipe, and clears them.
void ForceEngine::issue(const Stream& stream, uint32_t entry, uint64_t& mask) {
  const uint32_t record = stream.passes == 1 ? entry : entry / stream.passes;
  const uint32_t first_slot = (entry - record * stream.passes) * lanes_;
  const Candidate& other = *stream.record[record];
  for (int pipe = 0; pipe < plan_.arch.force_pipes && mask != 0; ++pipe) {
    const size_t slot = first_slot + static_cast<size_t>(std::countr_zero(mask));
    mask &= mask - 1;
    meet(own_[slot], 0, slot, other);
  }
}

uint64_t ForceEngine::stream() {
  static thread_local Stream stream;  // of the node that runs: a lattice of nodes shares the cache lines
  filter(stream);
  return clock_force(plan_, stream, segments_, available_, counts_,
                     [&](uint32_t entry, uint64_t& mask) { issue(stream, entry, mask); });
}

// One candidate at a time: read, then walked past the slots by way of the registers T and R.
uint64_t ForceEngine::walk() {
  static thread_local Stream stream;
  filter(stream);
  const uint32_t n = static_cast<uint32_t>(own_.size());
  const auto interval = static_cast<uint64_t>(plan_.latency.interval);
  uint64_t cycle = available_[0], ready = cycle, empty = cycle;  // the pipe takes a pair; holds none
  uint32_t entry = 0;
  for (int segment = 0; segment < segments_; ++segment) {
    if (entry == stream.segment_end[segment]) ++cycle;
    for (; entry < stream.segment_end[segment]; entry += n) {
      cycle += 1 + (segment == 0 ? 1 : static_cast<uint64_t>(plan_.words.halo_beats));
      std::optional<uint32_t> tested = 0, result;  // T, R
      for (uint32_t next = 1, done = 0; done < n; ++cycle) {
        if (result && stream.mask[entry + *result] != 0) {
          if (cycle < ready) {
            ++counts_.stalls;
            continue;
          }
          uint64_t mask = 1;
          issue(stream, entry + *result, mask);
          ++counts_.issue_cycles;
          ready = cycle + interval;
          empty = cycle + static_cast<uint64_t>(plan_.latency.pipe);
          ++done;
          result = tested;
          tested.reset();  // the pipe's own particle was asked for
          continue;
        }
        done += result.has_value();
        result = tested;
        tested = next < n ? std::optional(next++) : std::nullopt;
      }
      counts_.candidates += n;
    }
  }
  cycle = std::max(cycle, empty);
  counts_.busy += cycle - available_[0] + 1;
  return cycle;
}

}  // namespace cuboct::emu
