// SPDX-License-Identifier: MIT
// The force engine's cycles against the registers of docs/reference/node.md, stepped one by one.
#include "emu/systemc/force_engine.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

struct Engine {
  std::vector<emu::Slot> own;
  std::array<std::vector<emu::Candidate>, kFaces> halo;
  std::array<uint64_t, 4> available{};  // own, x, y, z
};

struct Outcome {
  uint64_t last = 0, stalls = 0, issue_cycles = 0, candidates = 0, pairs = 0;
  bool operator==(const Outcome&) const = default;
};

// Sentence by sentence: streamer, filter, queue, issue, pipes, end.
Outcome stepped(const Plan& plan, const Engine& engine) {
  struct Entry {
    const emu::Candidate* record;
    int self, pass;
  };
  const int n = static_cast<int>(engine.own.size()), lanes = plan.arch.filter_lanes;
  const auto mask_of = [&](const Entry& e) {
    uint64_t mask = 0;
    for (int l = 0; l < lanes; ++l) {
      const int slot = e.pass * lanes + l;
      if (slot >= n || slot == e.self) continue;
      const auto at = [](const emu::Candidate& c) { return Int3{c.x[0], c.x[1], c.x[2]}; };
      const bool meets =
          may_interact(plan.rule, at(engine.own[static_cast<size_t>(slot)].body), at(*e.record));
      mask |= uint64_t{meets} << l;
    }
    return mask;
  };
  Outcome out;
  std::array<std::optional<uint64_t>, 4> filter;  // F0 ... F3: what the mask will be
  std::deque<uint64_t> queue;
  uint64_t current = 0;
  int hold = 0;                    // cycles of the interval that are left
  std::optional<uint64_t> issued;  // cycle of the last pair
  size_t segment = 0, record = 0;
  int pass = 0;
  for (uint64_t cycle = engine.available[0];; ++cycle) {
    const auto pipe = static_cast<uint64_t>(plan.latency.pipe);
    const bool pipes_empty = !issued || cycle >= *issued + pipe;
    const bool filter_empty =
        std::none_of(filter.begin(), filter.end(), [](const auto& f) { return f.has_value(); });
    if (segment == 7 && filter_empty && queue.empty() && current == 0 && hold == 0 && pipes_empty) {
      out.last = cycle;
      return out;
    }
    const size_t held = queue.size();
    if (hold > 0) {
      --hold;
    } else if (current != 0) {
      hold = plan.latency.interval - 1;
      for (int p = 0; p < plan.arch.force_pipes && current != 0; ++p) current &= current - 1, ++out.pairs;
      issued = cycle;
      ++out.issue_cycles;
    }
    if (current == 0 && hold == 0 && held > 0) {
      current = queue.front();
      queue.pop_front();
    }
    if (filter[3] && *filter[3] != 0) {
      if (held == static_cast<size_t>(plan.arch.queue_depth)) {
        ++out.stalls;
        continue;
      }
      queue.push_back(*filter[3]);
    }
    for (size_t f = 3; f > 0; --f) filter[f] = filter[f - 1];
    filter[0].reset();
    if (segment == 7 || cycle < engine.available[(segment + 1) / 2]) continue;
    const size_t size = segment == 0 ? engine.own.size() : engine.halo[segment - 1].size();
    if (n == 0 || size == 0) {
      ++segment;
      continue;
    }
    filter[0] = mask_of(segment == 0 ? Entry{&engine.own[record].body, static_cast<int>(record), pass}
                                     : Entry{&engine.halo[segment - 1][record], -1, pass});
    ++out.candidates;
    if (++pass * lanes < n) continue;
    pass = 0;
    if (++record < size) continue;
    record = 0;
    ++segment;
  }
}

// With narrow memories: the port's questions and the registers T and R, cycle by cycle.
Outcome walked(const Plan& plan, const Engine& engine) {
  const size_t n = engine.own.size();
  Outcome out;
  uint64_t cycle = engine.available[0], pipe_free = 0, pipe_empty = 0;
  for (size_t segment = 0; segment < 7; ++segment) {
    const size_t size = segment == 0 ? n : engine.halo[segment - 1].size();
    if (n == 0 || size == 0) {
      ++cycle;
      continue;
    }
    for (size_t record = 0; record < size; ++record) {
      const emu::Candidate& j = segment == 0 ? engine.own[record].body : engine.halo[segment - 1][record];
      const auto at = [](const emu::Candidate& c) { return Int3{c.x[0], c.x[1], c.x[2]}; };
      const auto meets = [&](size_t slot) {
        return (segment > 0 || slot != record) && may_interact(plan.rule, at(engine.own[slot].body), at(j));
      };
      cycle += segment == 0
                   ? 1
                   : static_cast<uint64_t>(plan.words.halo_beats);  // words; the first slot in the last
      std::optional<size_t> asked = 0, t, r;
      size_t next = 1;
      bool first = true;
      for (;; ++cycle, first = false) {
        if (first) {
          ++out.candidates;
          continue;
        }
        t = asked ? asked : t;
        asked.reset();
        const bool hit = r && meets(*r);
        if (hit && cycle < pipe_free) {
          ++out.stalls;
          continue;
        }
        if (hit) {
          ++out.issue_cycles, ++out.pairs;
          pipe_free = cycle + static_cast<uint64_t>(plan.latency.interval);
          pipe_empty = cycle + static_cast<uint64_t>(plan.latency.pipe);
        } else if (next < n) {
          asked = next++;
          ++out.candidates;
        }
        r = t;
        t.reset();
        if (!r && !asked && next == n) break;
      }
      ++cycle;
    }
  }
  out.last = std::max(cycle, pipe_empty);
  return out;
}

TEST(NativeForceEngine, TakesTheCyclesOfItsRegisters) {
  std::mt19937_64 random(11);
  const auto draw = [&](int64_t low, int64_t high) {
    return std::uniform_int_distribution<int64_t>(low, high)(random);
  };
  Plan plan = make_case("undamped_2x2x2").setup.plan;
  const int64_t cell = int64_t{1} << plan.rule.widths.position_frac;
  uint64_t stalled = 0, empty = 0, waited = 0, passes = 0, narrow = 0;
  for (int run = 0; run < 3000; ++run) {
    plan.arch.capacity = 80;
    plan.arch.filter_lanes = static_cast<int>(draw(0, 3) == 0 ? draw(1, 64) : draw(1, 8));
    plan.arch.force_pipes = static_cast<int>(draw(1, std::min(3, plan.arch.filter_lanes)));
    plan.arch.queue_depth = static_cast<int>(draw(0, 1) ? draw(1, 3) : draw(1, 20));
    plan.latency.interval = static_cast<int>(draw(0, 1) ? 1 : draw(2, 4));
    plan.latency.pipe = plan.rounds[0].pipe = static_cast<int>(draw(plan.latency.interval, 14));
    plan.arch.narrow_memories = draw(0, 3) == 0;
    if (plan.arch.narrow_memories) plan.arch.filter_lanes = plan.arch.force_pipes = 1;
    plan.words.halo_beats = static_cast<int>(draw(1, 9));
    Engine engine;
    engine.own.resize(static_cast<size_t>(draw(0, 5) == 0 ? draw(0, 80) : draw(0, 9)));
    const int64_t spread = cell >> draw(0, 3);  // the nearer they lie the more pairs meet
    for (emu::Slot& s : engine.own)
      for (int32_t& x : s.body.x) x = static_cast<int32_t>(draw(0, spread - 1));
    for (size_t f = 0; f < kFaces; ++f) {
      engine.halo[f].resize(static_cast<size_t>(draw(0, 2) == 0 ? 0 : draw(0, 12)));
      for (emu::Candidate& c : engine.halo[f]) {
        for (int32_t& x : c.x) x = static_cast<int32_t>(draw(0, spread - 1));
        c.x[f / 2] += static_cast<int32_t>(f % 2 == 0 ? -cell : cell);
      }
    }
    engine.available[0] = static_cast<uint64_t>(draw(0, 1000));
    for (size_t a = 1; a < 4; ++a)
      engine.available[a] =
          engine.available[a - 1] +
          static_cast<uint64_t>(plan.arch.narrow_memories || draw(0, 2) == 0 ? 0 : draw(1, 60));

    emu::FaultKeeper fault;
    const emu::HaloTimes times;
    emu::ForceEngine tested(plan, engine.own, engine.halo, times, fault);
    tested.begin(engine.available[0]);
    for (int a = 0; a < 3; ++a) tested.available(a, engine.available[static_cast<size_t>(a) + 1]);
    const uint64_t last = tested.run();
    const emu::ForceCounts& counts = tested.counts();
    const Outcome expected = plan.arch.narrow_memories ? walked(plan, engine) : stepped(plan, engine);
    const Outcome got{last, counts.stalls, counts.issue_cycles, counts.candidates, counts.pairs_issued};
    ASSERT_TRUE(got == expected) << "run " << run << ": last cycle " << got.last << ", expected "
                                 << expected.last << "; stalls " << got.stalls << ", expected "
                                 << expected.stalls;
    EXPECT_EQ(counts.busy, last - engine.available[0] + 1);
    stalled += expected.stalls > 0;
    empty += engine.own.empty();
    waited += engine.available[3] > engine.available[2] + 20;
    passes += static_cast<int>(engine.own.size()) > plan.arch.filter_lanes;
    narrow += plan.arch.narrow_memories && expected.stalls > 0;
  }
  EXPECT_GT(stalled, 300u);
  EXPECT_GT(empty, 100u);
  EXPECT_GT(waited, 300u);
  EXPECT_GT(passes, 300u);
  EXPECT_GT(narrow, 100u);
}

}  // namespace
}  // namespace cuboct::test
