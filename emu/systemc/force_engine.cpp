// SPDX-License-Identifier: MIT
#include "emu/systemc/force_engine.h"

#include <algorithm>
#include <bit>
#include <tuple>

namespace cuboct::emu {

void FaultKeeper::add(Fault new_code, uint32_t new_id, int64_t new_number) {
  if (new_code == Fault::none) return;
  if (code == Fault::none || std::tie(new_code, new_id, new_number) < std::tie(code, id, number))
    code = new_code, id = new_id, number = new_number;
}

ForceEngine::ForceEngine(const Plan& plan, const std::vector<Slot>& own,
                         const std::array<std::vector<Candidate>, kFaces>& halo, FaultKeeper& fault)
    : plan_(plan),
      own_(own),
      halo_(halo),
      fault_(fault),
      lanes_(plan.arch.filter_lanes),
      pipes_(plan.arch.force_pipes),
      queue_(plan.arch.queue_depth),
      sum_(plan.arch.capacity) {}

void ForceEngine::reset() {
  active_ = f0_valid_ = f1_valid_ = false;
  current_.mask = 0;
  queue_head_ = queue_count_ = 0;
  drain_ = 0;
  std::fill(sum_.begin(), sum_.end(), Int3{});
}

void ForceEngine::begin() {
  active_ = true;
  segment_ = record_ = pass_ = 0;
}

int ForceEngine::segment_size(int segment) const {
  return static_cast<int>(segment == 0 ? own_.size() : halo_[segment - 1].size());
}

uint64_t ForceEngine::filter(const Entry& entry, int self) const {
  const int end = std::min(lanes_, static_cast<int>(own_.size()) - entry.first_slot);
  uint64_t mask = 0;
  for (int l = 0; l < end; ++l)
    mask |= static_cast<uint64_t>(may_interact(
                plan_.rule, difference(plan_.rule, own_[entry.first_slot + l].body.x, entry.candidate->x)))
            << l;
  const int own_lane = self - entry.first_slot;
  if (self >= 0 && own_lane >= 0 && own_lane < lanes_) mask &= ~(uint64_t{1} << own_lane);
  return mask;
}

void ForceEngine::issue() {
  for (int pipe = 0; pipe < pipes_ && current_.mask != 0; ++pipe) {
    const int slot = current_.first_slot + std::countr_zero(current_.mask);
    current_.mask &= current_.mask - 1;
    const Slot& i = own_[slot];
    const Candidate& j = *current_.candidate;
    const PairResult pair = pair_kick(plan_.rule, i.body.x, i.body.v, i.body.type, j.x, j.v, j.type);
    ++counts_.pairs_issued;
    counts_.pairs_inside += pair.inside;
    fault_.add(pair.fault, i.id, pair.number);
    for (int a = 0; a < 3; ++a) sum_[slot][a] += pair.kick[a];
  }
}

void ForceEngine::present(int available) {
  f0_valid_ = false;
  if (segment_ == kSegments || segment_ >= available) return;
  quiet_ = false;
  const int n = static_cast<int>(own_.size());
  if (n == 0 || segment_size(segment_) == 0) {
    ++segment_;
    return;
  }
  f0_valid_ = true;
  f0_self_ = segment_ == 0 ? record_ : -1;
  f0_ = {segment_ == 0 ? &own_[record_].body : &halo_[segment_ - 1][record_], pass_ * lanes_, 0};
  ++counts_.candidates;
  if (++pass_ * lanes_ < n) return;
  pass_ = 0;
  if (++record_ < segment_size(segment_)) return;
  record_ = 0;
  ++segment_;
}

bool ForceEngine::cycle(int available) {
  quiet_ = true;
  if (!active_) return false;
  ++counts_.busy;
  if (segment_ == kSegments && !f0_valid_ && !f1_valid_ && queue_count_ == 0 && current_.mask == 0 &&
      drain_ == 0) {
    active_ = quiet_ = false;
    return true;
  }
  quiet_ = !f0_valid_ && !f1_valid_ && queue_count_ == 0 && current_.mask == 0 && drain_ == 0;

  const uint32_t held = queue_count_;  // at the start of the cycle
  if (current_.mask != 0) {
    issue();
    ++counts_.issue_cycles;
    // Issued in cycle t, in the sum from t + pipe on: the pipe is empty in cycle t + pipe, and this edge ends
    // cycle t.
    drain_ = plan_.latency.pipe - 1;
  } else if (drain_ > 0) {
    --drain_;
  }
  if (current_.mask == 0 && held > 0) {
    current_ = queue_[queue_head_];
    queue_head_ = queue_head_ + 1 == queue_.size() ? 0 : queue_head_ + 1;
    --queue_count_;
  }
  if (f1_valid_ && f1_.mask != 0) {
    if (held == queue_.size()) {
      ++counts_.stalls;
      return false;
    }
    queue_[(queue_head_ + queue_count_) % queue_.size()] = f1_;
    ++queue_count_;
  }
  f1_valid_ = f0_valid_;
  if (f0_valid_) {
    f1_ = f0_;
    f1_.mask = filter(f0_, f0_self_);
  }
  present(available);
  return false;
}

Int3 ForceEngine::take_sum(int slot) {
  const Int3 sum = sum_[slot];
  sum_[slot] = {};
  return sum;
}

}  // namespace cuboct::emu
