// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/block_rounds.h"

#include <algorithm>
#include <bit>

namespace cuboct::emu {

void WantedGroups::find(const Particles& particles, const Block& block, const Active& active) {
  near.clear(), awake.clear(), is_near.clear();
  if (active.near == nullptr) return;
  is_near.resize(block.groups());
  for (uint32_t k = 0; k < block.groups(); ++k) {
    if (!any_flag(active.near, particles, block.first_group() + k)) continue;
    is_near[k] = 1;
    near.push_back(k);
    if (any_flag(active.awake, particles, block.first_group() + k)) awake.push_back(k);
  }
}

// Whom a round's code asks and tells.
struct BlockRounds::Owner {
  const RoundCode& code;
  const BondList& bonds;
  const RoundStep& step;
  Misfits misfits;
  bool both;  // ends are in this block
  const FinishJob* finishing = nullptr;

  Owner(const RoundCode& of, size_t k, const BondList& list, const RoundStep& now, bool both_ends)
      : code(of),
        bonds(list),
        step(now),
        misfits(of.program, of.program.rounds[k], of.rule, of.space, list, now),
        both(both_ends) {}

  static const Owner& from(void* owner) { return *static_cast<const Owner*>(owner); }
  void change(uint32_t p) const { step.active.mark(step.particles.cell[p]); }

  static bool meet(void* owner, uint32_t own, uint32_t other, uint64_t slot, double apart[3]) {
    const Owner& of = from(owner);
    std::array<double, 3> ends{apart[0], apart[1], apart[2]};
    const auto& x = of.step.particles.x;
    if (of.code.space.meets({x[0][own], x[1][own], x[2][own]}, ends)) {
      std::ranges::copy(ends, apart);
      return true;
    }
    if (!of.bonds.is_broken(of.code.program, of.code.space, slot)) of.misfits.add_lost(own, other, of.both);
    return false;
  }
  static void bond_changed(void* owner, uint32_t own, uint32_t other) {
    for (const uint32_t end : {own, other}) from(owner).change(end);
  }
  static void misfit(void* owner, uint32_t own, uint32_t other, const Entry& entry, uint64_t slot) {
    from(owner).misfits.add_pair(own, other, entry, slot, from(owner).both);
  }
  static void changed(void* owner, uint32_t p) { from(owner).change(p); }
  static void crossed(void* owner, uint32_t p, const int8_t away[3]) {
    from(owner).step.block.crossings.push_back({p, {away[0], away[1], away[2]}});
  }

  void give(Job& job) {
    job.bond_constants = code.constants.data();
    job.bond_constant_count = static_cast<int64_t>(code.program.bond_constants.size());
    job.owner = this;
    job.meet = meet;
    job.changed = step.active.changed != nullptr ? bond_changed : nullptr;
    job.misfit = misfit;
  }
  static void particle_misfit(void* owner, uint32_t first, uint32_t count) {
    from(owner).misfits.add_finish(*from(owner).finishing, first, count);
  }
  void give(FinishJob& job) {
    finishing = &job;
    job.owner = this;
    job.misfit = particle_misfit;
    job.changed = step.active.changed != nullptr ? changed : nullptr;
    job.crossed = crossed;
  }
};

namespace {

CodeNumbers numbers_of(const RoundCode& code) {
  return code.library != nullptr ? code.library->numbers() : CodeNumbers{};
}

// At least so many arrays of that size.
void make(Sums& sums, size_t count, size_t size) {
  if (sums.size() >= count && (count == 0 || sums[0].size() == size)) return;
  sums.clear();
  for (size_t t = 0; t < count; ++t) sums.emplace_back(size, kMagic);
}

// Of ascending numbers those below `end`, from the first that is left on.
std::span<const uint32_t> take_below(std::span<const uint32_t>& left, uint32_t end) {
  const auto count = static_cast<size_t>(std::ranges::lower_bound(left, end) - left.begin());
  const auto taken = left.first(count);
  left = left.subspan(count);
  return taken;
}

template <class AnyJob>
void choose(AnyJob& job, bool some_rest, std::span<const uint32_t> wanted, uint32_t begin, uint32_t end) {
  job.chosen = some_rest ? wanted.data() : nullptr;
  job.first = begin;
  job.count = some_rest ? static_cast<uint32_t>(wanted.size()) : end - begin;
}

}  // namespace

void BlockRounds::find_sides(const RoundCode& code, const Block& block) {
  const auto set = [](Side& side, const auto& group, const auto& groups, const auto& entries) {
    side.group = &group, side.groups = &groups, side.entries = entries.data();
  };
  sides_.resize(code.program.bonded ? 1 : 2);
  if (code.program.bonded) return set(sides_[0], bonds_.own_group, bonds_.own, bonds_.entries);
  const Edge* const edges[] = {&block.beside, &block.ghosts};
  for (size_t s = 0; s < 2; ++s)
    set(sides_[s], edges[s]->group, edges[s]->pairs.groups, edges[s]->pairs.entries);
}

// Room for sums as far ahead as entries lead, and for a stretch whose groups are met before any is finished.
void BlockRounds::make_rings(const RoundCode& code, const Block& block) {
  window_ = code.program.bonded ? bonds_.window : block.window;
  const uint32_t size = std::bit_ceil(window_ + (kStretch + 1) * kGroup);
  if (size <= mask_ + 1 && !rings_.empty()) return;
  mask_ = size - 1;
  rings_.resize(code.program.rounds.size());
  for (size_t k = 0; k < rings_.size(); ++k)
    make(rings_[k], static_cast<size_t>(code.program.rounds[k].numbers()), size);
}

void BlockRounds::meet(const RoundCode& code, size_t k, Ends ends, const Job& job) {
  if (code.library != nullptr) return code.library->meet(k, ends)(job);
  while (pairs_.size() <= k)
    pairs_.push_back(std::make_unique<PairPass>(code.program, code.program.rounds[pairs_.size()]));
  pairs_[k]->run(job, ends);
}

void BlockRounds::finish(const RoundCode& code, size_t k, const FinishJob& job) {
  if (code.library != nullptr) return code.library->finish(k)(job);
  while (finishes_.size() <= k)
    finishes_.push_back(std::make_unique<FinishPass>(code.program, code.program.rounds[finishes_.size()]));
  finishes_[k]->run(job);
}

void BlockRounds::across(const RoundCode& code, size_t k, const RoundStep& step) {
  const bool some_rest = step.active.near != nullptr;
  if (k == 0) {
    wanted_.find(step.particles, step.block, step.active);
    make_rings(code, step.block);
    find_sides(code, step.block);
  }
  Owner owner(code, k, bonds_, step, false);
  if (k == 0)
    for (const auto& [own, other] : lost) step.block.pair_faults.push_back({Fault::bond_lost, own, other});
  const Jobs jobs(step, code.rule, numbers_of(code), bonds_);
  for (Side& side : sides_) {
    side.next = 0;
    make(side.sums, static_cast<size_t>(code.program.rounds[k].numbers()), side.group->size() * kGroup);
    if (side.group->empty()) continue;
    for (size_t g = 0; g < side.group->size(); ++g)
      if (!some_rest || wanted_.is_near[(*side.group)[g]] != 0)
        for (auto& sum : side.sums) std::fill_n(sum.data() + g * kGroup, kGroup, kMagic);
    const std::vector<double*> sums = pointers(side.sums);
    Job job = jobs.pairs();
    owner.give(job);
    job.sums = sums.data(), job.mask = ~uint32_t{0};
    job.entries = side.entries, job.groups = side.groups->data(), job.group_of = side.group->data();
    job.count = static_cast<uint32_t>(side.group->size());
    job.wanted = some_rest ? wanted_.is_near.data() : nullptr;
    meet(code, k, Ends::own, job);
  }
}

// What came from other blocks, and, where the ring begins anew, from entries that overhung its end.
void BlockRounds::add_sides(Sums& ring, uint32_t begin, uint32_t end, bool some_rest) {
  const auto add = [](double* to, const double* from) {
    for (uint32_t l = 0; l < kGroup; ++l) to[l] += from[l] - kMagic;
  };
  for (Side& side : sides_) {
    const std::vector<uint32_t>& group = *side.group;
    for (; side.next < group.size() && group[side.next] < end; ++side.next) {
      if (group[side.next] < begin || (some_rest && wanted_.is_near[group[side.next]] == 0)) continue;
      for (size_t t = 0; t < ring.size(); ++t)
        add(ring[t].data() + (group[side.next] * kGroup & mask_), side.sums[t].data() + side.next * kGroup);
    }
  }
  if ((begin * kGroup & mask_) == 0)
    for (auto& sums : ring) add(sums.data(), sums.data() + mask_ + 1);
}

void BlockRounds::clear(Sums& ring, uint32_t begin, uint32_t end) const {
  const uint32_t place = begin * kGroup & mask_;
  for (auto& sums : ring) {
    std::fill_n(sums.data() + place, (end - begin) * kGroup, kMagic);
    if (place == 0) std::fill_n(sums.data() + mask_ + 1, kGroup, kMagic);
  }
}

void BlockRounds::meet_inside(const RoundCode& code, size_t k, const Block& block, Job& job) {
  if (code.program.bonded && !code.once) return;  // all pairs are those of sides_
  job.entries = code.program.bonded ? bonds_.entries.data() : block.inside.entries.data();
  job.groups = code.program.bonded ? bonds_.both.data() : block.inside.groups.data();
  if (code.once) return meet(code, k, Ends::both, job);
  for (const Ends ends : {Ends::own, Ends::other}) meet(code, k, ends, job);
}

void BlockRounds::inside(const RoundCode& code, size_t k, const RoundStep& step) {
  const bool some_rest = step.active.near != nullptr;
  Sums& ring = rings_[k];
  const std::vector<double*> sums = pointers(ring);
  Owner owner(code, k, bonds_, step, true);
  const Jobs jobs(step, code.rule, numbers_of(code), bonds_);
  Job pairs = jobs.pairs();
  FinishJob finishing = jobs.finish();
  owner.give(pairs), owner.give(finishing);
  pairs.sums = sums.data(), finishing.sums = sums.data();
  pairs.mask = finishing.mask = mask_;
  std::span<const uint32_t> near(wanted_.near), awake(wanted_.awake);
  uint32_t written = 0;  // groups below may have sums in the ring
  for (uint32_t begin = 0; begin < step.block.groups(); begin += kStretch) {
    const uint32_t end = std::min(begin + kStretch, step.block.groups());
    const auto near_here = take_below(near, end), awake_here = take_below(awake, end);
    if (some_rest && near_here.empty() && begin >= written) continue;
    if (!some_rest || !near_here.empty()) {
      choose(pairs, some_rest, near_here, begin, end);
      meet_inside(code, k, step.block, pairs);
      written = end + groups_of(window_ + kGroup);
    }
    if (!some_rest || !awake_here.empty()) {
      add_sides(ring, begin, end, some_rest);
      choose(finishing, some_rest, awake_here, begin, end);
      finish(code, k, finishing);
    }
    clear(ring, begin, end);
  }
}

}  // namespace cuboct::emu
