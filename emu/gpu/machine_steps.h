// SPDX-License-Identifier: MIT
// Machine: steps in batches.
#pragma once

#include "emu/gpu/machine.h"
#include "emu/gpu/steps_together.h"

namespace cuboct::gpu {

struct ResetControl {
  Control* control;
  CUBOCT_DEVICE void operator()(uint32_t) const { *control = {0, kNever, kNever, kNever, kNever, kNever}; }
};
struct RaiseBase {
  Control* control;
  uint32_t steps;
  CUBOCT_DEVICE void operator()(uint32_t) const { control->base += steps; }
};

// A step of a slab from the copy that holds the state to the other one.
template <class Policy>
template <class Step>
Step Machine<Policy>::filled(Slab& s) {
  // Where the allowed displacement is below an anchor's resolution, the list is made anew every step.
  const auto square = [](double length) { return length > 0 ? static_cast<float>(length * length) : -1.0f; };
  Step f{};
  f.view = s.rule->view(), f.grid = grid(s), f.from = at(s, at_), f.to = at(s, 1 - at_), f.list = list(s);
  f.near = {s.near_entries.data(), s.near_counts.data()};
  f.near2 = square(reach_of(near_skin())), f.inside2 = square(reach_of(0));
  f.range = static_cast<float>(range()), f.near_allowed = static_cast<float>(near_allowed());
  if (const Slab* lower = beside(s, 0))
    f.copies[0] = {lower->x[1 - at_].data(), setup_.damped ? lower->v[1 - at_].data() : nullptr, 0, s.low_end,
                   int64_t{lower->lower_copy_end}};
  if (const Slab* upper = beside(s, 1))
    f.copies[1] = {upper->x[1 - at_].data(), setup_.damped ? upper->v[1 - at_].data() : nullptr, s.high_begin,
                   s.own, int64_t{upper->own} - int64_t{s.high_begin}};
  if constexpr (Policy::kFixed) {
    const SlabCells& cells = cells_of(s);
    f.occupancy = {s.occupancy.data(),   nullptr,         nullptr,         cells.own_end,
                   cells.lower_copy_end, setup_.capacity, s.entered.data()};
    if (const Slab* lower = beside(s, 0))
      f.occupancy.lower = lower->occupancy.data() + cells_of(*lower).inner_end;
    if (const Slab* upper = beside(s, 1)) f.occupancy.upper = upper->occupancy.data();
  }
  f.cell = s.cell.data(), f.farthest2 = square(farthest()), f.control = s.control.data();
  for (const auto& other : slabs_)
    if (other.get() != &s) f.others.at[f.others.count++] = other->control.data();
  return f;
}

// The step from the copy that holds the state to the other one.
template <class Policy>
void Machine<Policy>::step(uint32_t number, bool hash, bool makes_near) {
  const auto launch = [&](Slab& s, Stream& stream, uint32_t begin, uint32_t end, uint32_t jump_at,
                          uint32_t jump_by) {
    if (begin == end) return;
    const auto run = [&](auto f) {
      f.number = number, f.jump_at = jump_at, f.jump_by = jump_by;
      for_each_cached(stream, begin, end, options_.block, s.rule->cache(), s.rule->cache_words(), f);
    };
    Policy::with_variant(s.rule->view(), [&](auto variant) {
      if (makes_near)
        run(filled<Step<Policy, decltype(variant), true>>(s));
      else
        run(filled<Step<Policy, decltype(variant), false>>(s));
    });
  };
  const size_t now = number % 2, last = 1 - now;
  if (!alone())
    for (auto& slab : slabs_) {
      // What the neighbours wrote in the step before is read now; what is written now they have read by then.
      // And what is written now takes the place of the state before that step, which is wanted where a
      // particle of any slab, at its border or not, found the step impossible.
      if (number > 1)
        for (auto& other : slabs_) {
          if (other != slab) slab->edge.wait(other->border_done[last]);
          slab->edge.wait(other->inner_done[last]);
        }
      slab->edge.record(slab->begun[now]);
      launch(*slab, slab->edge, 0, slab->low_end + (slab->own - slab->high_begin), slab->low_end,
             slab->high_begin - slab->low_end);
      slab->edge.record(slab->border_done[now]);
    }
  for (auto& slab : slabs_) {
    if (!alone()) slab->stream.wait(slab->begun[now]);
    launch(*slab, slab->stream, slab->low_end, slab->high_begin, kNever, 0);
    if (!alone()) slab->stream.record(slab->inner_done[now]);
    if (hash && !alone()) slab->stream.wait(slab->border_done[now]);
    if (!hash) continue;
    if constexpr (Policy::kFixed) {
      const HashEach<Policy> f{slab->rule->view(), grid(*slab), at(*slab, 1 - at_),  slab->cell.data(),
                               slab->id.data(),    number,      slab->control.data()};
      sum_each(slab->stream, 0, slab->own, options_.block, f, slab->hashes.data() + number);
    }
  }
  at_ = 1 - at_;
}

// Whether the next step makes near lists.
template <class Policy>
bool Machine<Policy>::next_makes_near() {
  const bool makes_near = near_age_ == kNever || near_age_ >= near_every_;
  near_age_ = makes_near ? 1 : near_age_ + 1;
  return makes_near;
}

// Near lists live longer where they have served to their end, and shorter where they have not.
template <class Policy>
void Machine<Policy>::plan_near_lists(const Outcome& outcome) {
  const uint32_t before = near_every_;
  if (outcome.end == End::near_list) {
    ++counters.near_stops;
    near_age_ = kNever;
    near_every_ = std::max(near_every_ / 2, 1u);
    near_good_ = 0;
    near_patience_ = std::min(2 * near_patience_, 4096u);
  } else if ((near_good_ += static_cast<uint32_t>(outcome.done) / near_every_) >= near_patience_) {
    near_every_ = std::min(2 * near_every_, kNearLongest);
    near_good_ = 0;
  }
  if (near_every_ != before)
    for (auto& slab : slabs_)
      for (Graph& graph : slab->graph) graph.drop();
}

// All steps of a batch in one launch. False: they are more than the device holds at once.
template <class Policy>
bool Machine<Policy>::run_together(uint32_t steps, bool hash) {
  // More doubles than have eight lanes are done sooner by a launch for each step.
  [[maybe_unused]] constexpr bool kDoubles = sizeof(typename Policy::Position) > 16;
  Slab& s = *slabs_.front();
  bool ran = false;
  Policy::with_variant(s.rule->view(), [&](auto variant) {
    const StepsTogether<Policy, decltype(variant)> f{filled<Step<Policy, decltype(variant), false>>(s),
                                                     s.id.data(), hash};
    const auto go_on = [&](auto lanes, bool has_choice) {
      return go_on_together<decltype(lanes)>(s.stream, s.own, options_.block, s.rule->cache(),
                                             s.rule->cache_words(), steps, s.meeting, s.hashes.data(),
                                             has_choice, f);
    };
    // A device that does not hold so many threads, or is shared, may hold those of fewer lanes.
    ran = particles_ <= kMostOfEightLanes && go_on(PairLanes<8>(), !kDoubles);
    if constexpr (!kDoubles)
      ran = ran || (particles_ <= kMostOfFourLanes && go_on(PairLanes<4>(), true)) ||
            go_on(PairLanes<2>(), false);
  });
  if (ran) near_age_ = kNever;  // steps over near lists go on with new ones
  return ran;
}

template <class Policy>
void Machine<Policy>::start_batch(uint32_t steps, bool hash) {
  for (auto& slab : slabs_) {
    for_each(slab->stream, 0, 1, 32, ResetControl{slab->control.data()});
    if (hash) slab->hashes.zero(slab->stream);
  }
  if (alone() && particles_ <= options_.together && run_together(steps, hash)) return;
  // Another slab's first step may write into this one's memory.
  if (!alone()) wait_for_all();
  // A graph pays where it is launched several times: once a list has lived for a while.
  uint32_t done = 0;
  if (kHasGraphs && alone() && !hash && age_ >= 2 * kGraphSteps) {
    Slab& only = *slabs_.front();
    for (; done + kGraphSteps <= steps; done += kGraphSteps) {
      Graph& graph = only.graph[at_];
      if (!graph.ready()) {
        graph.begin(only.stream);
        for (uint32_t k = 1; k <= kGraphSteps; ++k) step(k, false, (k - 1) % near_every_ == 0);
        for_each(only.stream, 0, 1, 32, RaiseBase{only.control.data(), kGraphSteps});
        graph.end(only.stream);
      }
      graph.launch(only.stream);
    }
    // What follows counts on.
    if (done > 0) near_age_ = near_every_;
    for (uint32_t k = 1; done < steps; ++k, ++done) step(k, false, next_makes_near());
  }
  for (uint32_t k = done + 1; k <= steps; ++k) step(k, hash, next_makes_near());
  wait_for_all();
}

template <class Policy>
typename Machine<Policy>::Outcome Machine<Policy>::run(uint64_t wanted, std::vector<uint64_t>* hashes) {
  const auto steps = static_cast<uint32_t>(std::min<uint64_t>(wanted, batch_));
  const int begin = at_;
  start_batch(steps, hashes != nullptr);
  Outcome outcome{steps, End::full};
  uint32_t doubt = kNever, crowded = kNever, old = kNever, near_old = kNever;
  for (auto& slab : slabs_) {
    const Control told = slab->control.host(slab->stream, 0, 1)[0];
    const uint64_t done = std::min(told.limit, steps);
    outcome.done = std::min(outcome.done, done);
    doubt = std::min(doubt, told.doubt), crowded = std::min(crowded, told.crowded);
    old = std::min(old, told.old), near_old = std::min(near_old, told.near_old);
  }
  if (crowded == outcome.done + 1)
    outcome.end = End::crowded;
  else if (doubt == outcome.done + 1)
    outcome.end = End::doubt;
  else if (old == outcome.done)
    outcome.end = End::list;
  else if (near_old == outcome.done)
    outcome.end = End::near_list;
  plan_near_lists(outcome);
  at_ = static_cast<int>((static_cast<uint64_t>(begin) + outcome.done) % 2);
  age_ += outcome.done;
  if (hashes) {
    std::vector<uint64_t> sums(outcome.done, 0);
    for (auto& slab : slabs_) {
      const std::vector<uint64_t> part = slab->hashes.host(slab->stream, 1, outcome.done);
      for (size_t k = 0; k < part.size(); ++k) sums[k] += part[k];
    }
    hashes->insert(hashes->end(), sums.begin(), sums.end());
  }
  if (outcome.end == End::near_list) {
    batch_ = std::max(batch_ / 4, kGraphSteps);
  } else if (outcome.end == End::full) {
    if (steps == batch_) batch_ = std::min(2 * batch_, kLongest);
  } else {  // about as long as lists live
    batch_ = 8;
    while (batch_ * 2 <= age_ && batch_ < kLongest) batch_ *= 2;
  }
  return outcome;
}

}  // namespace cuboct::gpu
