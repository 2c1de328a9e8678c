// SPDX-License-Identifier: MIT
#include "emu/systemc/force_engine.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "emu/systemc/planar.h"
#include "model/program/integer_program.h"

namespace cuboct::emu {
namespace {

constexpr auto kId = &std::pair<uint32_t, uint32_t>::first;

}  // namespace

// An entry is a (record, pass).
struct ForceEngine::Stream : ForceStream {
  std::vector<const Candidate*> record;  // of all segments
  uint32_t passes = 1;
  PlanarSlots own;
  std::vector<std::pair<uint32_t, uint32_t>> partners;  // of a bonded rule: (id, own slot), ascending
};

ForceEngine::ForceEngine(const Plan& plan, std::vector<Slot>& own,
                         const std::array<std::vector<Candidate>, kFaces>& halo, const HaloTimes& times,
                         FaultKeeper& fault)
    : ForceMachine(plan, 1, fault),
      own_(own),
      halo_(halo),
      times_(times),
      bonded_(plan.program && plan.program->program.bonded) {
  if (plan.program) rounds_ = std::make_unique<RoundWork>(plan, own, fault);
}

void ForceEngine::begin_filter(Stream& stream) const {
  stream.record.clear();
  stream.mask.clear();
  stream.passes = (static_cast<uint32_t>(own_.size()) + lanes_ - 1) / lanes_;
  if (bonded_) {
    stream.partners.clear();
    for (uint32_t k = 0; k < own_.size(); ++k)
      for (const Bond& bond : own_[k].bonds) stream.partners.emplace_back(bond.other, k);
    std::ranges::sort(stream.partners);
    return;
  }
  stream.own.clear();
  for (const Slot& s : own_) stream.own.add(s.body.x, test_.shift());
}

void ForceEngine::meet_slots(Stream& stream, const Candidate& c, uint32_t self) const {
  const uint64_t lane_mask = ~uint64_t{0} >> (64 - lanes_);
  stream.record.push_back(&c);
  PlanarMask met;
  if (bonded_) {
    auto partner = std::ranges::lower_bound(stream.partners, c.id, {}, kId);
    for (; partner != stream.partners.end() && partner->first == c.id; ++partner) met.set(partner->second);
  } else {
    met = test_(stream.own, c.x);
  }
  if (self < own_.size()) met.clear(self);
  for (uint32_t p = 0; p < stream.passes; ++p) stream.mask.push_back(met.from(p * lanes_) & lane_mask);
}

// Lists the records and tests each against all own slots.
void ForceEngine::filter(Stream& stream) const {
  const uint32_t n = static_cast<uint32_t>(own_.size());
  begin_filter(stream);
  for (int segment = 0; segment < segments_; ++segment) {
    if (segment > 0)
      for (const Candidate& c : halo_[segment - 1]) meet_slots(stream, c, n);
    else
      for (uint32_t k = 0; k < n; ++k) meet_slots(stream, own_[k].body, k);
    stream.segment_end[segment] = static_cast<uint32_t>(stream.mask.size());
  }
}

void ForceEngine::count_faces(const Stream& stream) {
  for (size_t segment = 1; segment < static_cast<size_t>(segments_); ++segment)
    counts_.by_axis[(segment - 1) / 2] += stream.segment_end[segment] - stream.segment_end[segment - 1];
}

// Issues the lowest bits of `mask`, one per pipe, and clears them.
void ForceEngine::issue(const Stream& stream, uint32_t entry, uint64_t& mask) {
  const uint32_t record = stream.passes == 1 ? entry : entry / stream.passes;
  const uint32_t first_slot = (entry - record * stream.passes) * lanes_;
  const Candidate& other = *stream.record[record];
  for (int pipe = 0; pipe < plan_.arch.force_pipes / plan_.arch.streamers && mask != 0; ++pipe) {
    const size_t slot = first_slot + static_cast<size_t>(std::countr_zero(mask));
    mask &= mask - 1;
    meet(own_[slot], 0, slot, other);
  }
}

uint64_t ForceEngine::stream() {
  static thread_local Stream stream;  // of the node that runs: a lattice of nodes shares the cache lines
  filter(stream);
  count_faces(stream);
  const uint64_t last = clock_force(plan_, stream, segments_, available_, pipe(), counts_,
                                    [&](uint32_t entry, uint64_t& mask) { issue(stream, entry, mask); });
  if (rounds_) counts_.pairs_inside += rounds_->add();
  return last;
}

// Streamer 0 walks the own particles and the faces below, streamer 1 those above; one alone walks all. A
// record that came before the step was not tested against the box of the own particles.
uint64_t ForceEngine::arrive() {
  static thread_local Stream stream;
  static thread_local std::vector<uint64_t> there;  // by entry
  const uint32_t n = static_cast<uint32_t>(own_.size());
  const uint64_t begin = available_[0];
  Int3 low{}, high{};
  for (size_t a = 0; a < 3 && n > 0; ++a) {
    const auto at = [a](const Slot& s) { return s.body.x[a]; };
    const auto [least, most] = std::ranges::minmax(own_, {}, at);
    low[a] = at(least), high[a] = at(most);
  }
  const auto reaches = [&](const Candidate& c) {
    Int3 x, nearest;
    for (size_t a = 0; a < 3; ++a) x[a] = c.x[a], nearest[a] = std::clamp(x[a], low[a], high[a]);
    return may_interact(plan_.rule, nearest, x);
  };
  uint64_t last = begin;
  for (int streamer = 0; streamer < plan_.arch.streamers; ++streamer) {
    begin_filter(stream);
    there.clear();
    std::array<uint64_t, kForceSegments> complete{};
    size_t segments = 0;
    const auto end_segment = [&](uint64_t known) {
      complete[segments] = known;
      stream.segment_end[segments++] = static_cast<uint32_t>(stream.mask.size());
    };
    if (streamer == 0) {
      for (uint32_t k = 0; k < n; ++k) meet_slots(stream, own_[k].body, k);
      there.resize(stream.mask.size(), begin);
      end_segment(begin);
    }
    for (size_t face = static_cast<size_t>(streamer); face < static_cast<size_t>(segments_) - 1;
         face += static_cast<size_t>(plan_.arch.streamers)) {
      const auto& halo = halo_[face];
      const size_t before = stream.mask.size();
      for (size_t k = 0; k < halo.size(); ++k) {
        const uint64_t came = times_.came[face][k];
        const bool tested = came + 1 >= begin;
        counts_.tested += tested;
        if (tested && (n == 0 || !reaches(halo[k]))) {
          ++counts_.culled[face / 2];
          continue;
        }
        if (n == 0) continue;
        meet_slots(stream, halo[k], n);
        there.resize(stream.mask.size(), came + 1 + kCullStages);
      }
      counts_.by_axis[face / 2] += stream.mask.size() - before;
      end_segment(times_.ended[face] == 0 ? begin : times_.ended[face] + 1 + kCullStages);
    }
    last = std::max(last, clock_stream(
                              plan_, stream, static_cast<int>(segments), begin,
                              [](int, uint32_t entry) { return there[entry]; },
                              [&](int segment) { return complete[static_cast<size_t>(segment)]; }, 1, pipe(),
                              counts_, [&](uint32_t entry, uint64_t& mask) { issue(stream, entry, mask); }));
  }
  last = std::max(last, available_[static_cast<size_t>(plan_.rule.axes)]);
  counts_.busy += last - begin + 1;
  return last;
}

// One candidate at a time: read, then walked past the slots by way of the registers T and R.
uint64_t ForceEngine::walk() {
  static thread_local Stream stream;
  filter(stream);
  count_faces(stream);
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
