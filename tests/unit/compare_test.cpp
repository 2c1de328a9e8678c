// SPDX-License-Identifier: MIT
// The comparison must see every field: each test changes one and expects exactly that one to be named.
#include "model/trace/compare.h"

#include <gtest/gtest.h>

#include "tests/unit/made_trace.h"

namespace cuboct {
namespace {

using Kind = Mismatch::Kind;

Lattice two_nodes() { return Lattice({{0, 0, 0}, {1, 0, 0}}, {0, 0, 0}); }

template <typename Change>
std::string difference_after(Change change) {
  Trace other = made_trace();
  change(other);
  const auto mismatch = compare(made_trace(), other);
  return mismatch ? mismatch->text("golden", "rtl", two_nodes()) : "equal";
}

template <typename Change>
std::string frame_difference_after(Change change) {
  State other = made_state(2);
  change(other.particles);
  const auto mismatch = compare(made_state(2), other);
  return mismatch ? mismatch->text("golden", "rtl", two_nodes()) : "equal";
}

TEST(Compare, EqualTracesHaveNoMismatch) {
  EXPECT_EQ(difference_after([](Trace&) {}), "equal");
  EXPECT_EQ(updates_compared(made_trace(), 3), 6u);
}

TEST(Compare, NamesTheFirstDifferenceOfEachKind) {
  EXPECT_EQ(difference_after([](Trace& t) { t.plan_hash ^= 1; }),
            "plan hash: golden fedcba9876543210, rtl fedcba9876543211");
  EXPECT_EQ(difference_after([](Trace& t) { t.nodes = 1; }), "nodes: golden 2, rtl 1");
  EXPECT_EQ(difference_after([](Trace& t) { t.state_hash[0] = 0x10; }),
            "step 0, state hash: golden 0000000000000001, rtl 0000000000000010");
  EXPECT_EQ(difference_after([](Trace& t) { t.state_hash[2] = 4; }),
            "step 2, state hash: golden 0000000000000003, rtl 0000000000000004");
  EXPECT_EQ(difference_after([](Trace& t) { t.state_hash.pop_back(); }), "steps done: golden 2, rtl 1");
}

Trace hashed(uint64_t every, uint64_t steps) {
  Trace trace;
  trace.hash_every = every;
  trace.steps_done = steps;
  for (uint64_t step = 0; step <= steps; ++step)
    if (trace.hashes(step, steps)) trace.state_hash.push_back(100 + step);
  return trace;
}

TEST(Compare, LooksAtTheStepsThatBothHashed) {
  // Of 0 ... 20: 0, 4, 8, 12, 16, 20 and 0, 6, 12, 18, 20 have 0, 12 and 20 in common.
  EXPECT_EQ(states_compared(hashed(4, 20), hashed(6, 20)), 3u);
  EXPECT_EQ(states_compared(hashed(1, 20), hashed(6, 20)), 5u);
  EXPECT_EQ(states_compared(hashed(1, 20), hashed(1, 20)), 21u);
  EXPECT_FALSE(compare(hashed(4, 20), hashed(6, 20)));
  EXPECT_FALSE(compare(hashed(1, 20), hashed(7, 20)));
  const auto difference = [](uint64_t every_a, uint64_t every_b, size_t at) {
    Trace other = hashed(every_b, 20);
    other.state_hash[at] = 0;
    const auto mismatch = compare(hashed(every_a, 20), other);
    return mismatch ? mismatch->text("golden", "lattice", two_nodes()) : "equal";
  };
  EXPECT_EQ(difference(4, 6, 2),
            "step 12 (equal at step 0), state hash: golden 0000000000000070, lattice 0000000000000000");
  EXPECT_EQ(difference(4, 6, 4),
            "step 20 (equal at step 12), state hash: golden 0000000000000078, lattice 0000000000000000");
  EXPECT_EQ(difference(4, 6, 1), "equal");  // step 6: golden has no hash of it
  EXPECT_EQ(difference(1, 6, 1),
            "step 6 (equal at step 0), state hash: golden 000000000000006a, lattice 0000000000000000");
  EXPECT_EQ(difference(1, 1, 6), "step 6, state hash: golden 000000000000006a, lattice 0000000000000000");
  const auto length = compare(hashed(4, 20), hashed(4, 17));
  ASSERT_TRUE(length);
  EXPECT_EQ(length->text("golden", "lattice", two_nodes()), "steps done: golden 20, lattice 17");
}

TEST(Compare, NamesEachFieldOfAStop) {
  EXPECT_EQ(difference_after([](Trace& t) { t.stop.reset(); }),
            "stop, fault: golden velocity out of width, rtl none");
  EXPECT_EQ(difference_after([](Trace& t) { t.stop->fault = Fault::sum; }),
            "stop, fault: golden velocity out of width, rtl sum of kicks out of width");
  EXPECT_EQ(difference_after([](Trace& t) { t.stop->step = 1; }), "stop, step: golden 2, rtl 1");
  EXPECT_EQ(difference_after([](Trace& t) { t.stop->cell = 0; }), "stop, cell: golden 1, rtl 0");
  EXPECT_EQ(difference_after([](Trace& t) { t.stop->particle = 1; }), "stop, particle: golden 5, rtl 1");
  EXPECT_EQ(difference_after([](Trace& t) { t.stop->number = 7; }),
            "stop, number: golden -1099511627776, rtl 7");
}

TEST(Compare, NamesEveryPhaseTime) {
  const Lattice lattice = two_nodes();
  for (size_t i = 0; i < made_trace().cycles.size(); ++i)
    for (const bool start : {true, false}) {
      Trace other = made_trace();
      uint64_t& value = start ? other.cycles[i].start : other.cycles[i].end;
      const uint64_t was = value;
      value += 1;
      const auto mismatch = compare(made_trace(), other);
      ASSERT_TRUE(mismatch);
      const auto node = static_cast<unsigned>(i / kPhases % 2);
      EXPECT_EQ(mismatch->text("golden", "rtl", lattice),
                "step " + std::to_string(i / kPhases / 2) + ", node " + std::to_string(node) + " (cell " +
                    std::to_string(node) + " 0 0), " + to_string(static_cast<Phase>(i % kPhases)) +
                    (start ? " start" : " end") + ": golden " + std::to_string(was) + ", rtl " +
                    std::to_string(was + 1));
    }
}

TEST(Compare, EnginesWithoutCyclesAgreeWithThoseThatCount) {
  EXPECT_EQ(difference_after([](Trace& t) { t.cycles.clear(); }), "equal");
  EXPECT_EQ(difference_after([](Trace& t) { t.cycles.resize(16); }),
            "step 1, number: golden 32 phase times, rtl 16 phase times");
}

TEST(Compare, LeavesHostTimeAndCountersOut) {
  EXPECT_EQ(difference_after([](Trace& t) { t.seconds = 9, t.counters.clear(), t.engine = "rtl"; }), "equal");
}

TEST(Compare, NamesEachFieldOfAParticle) {
  using Particles = std::vector<Particle>;
  EXPECT_EQ(frame_difference_after([](Particles&) {}), "equal");
  EXPECT_EQ(frame_difference_after([](Particles& p) { p[1].type = 0; }),
            "step 2, cell 0 (0 0 0), particle 1, type: golden 1, rtl 0");
  EXPECT_EQ(frame_difference_after([](Particles& p) { p[2].cell = 0; }),
            "step 2, cell 1 (1 0 0), particle 5, cell: golden 1, rtl 0");
  const char* names[] = {"x", "v", "u"};
  for (int field = 0; field < 3; ++field)
    for (int axis = 0; axis < 3; ++axis) {
      State other = made_state(2);
      Particle& particle = other.particles[1];
      int64_t& value = (field == 0 ? particle.x : field == 1 ? particle.v : particle.u)[axis];
      const std::string was = std::to_string(value);
      value ^= 1;
      const auto mismatch = compare(made_state(2), other);
      ASSERT_TRUE(mismatch);
      EXPECT_EQ(mismatch->text("golden", "rtl", two_nodes()),
                std::string("step 2, cell 0 (0 0 0), particle 1, ") + names[field] + "." + "xyz"[axis] +
                    ": golden " + was + ", rtl " + std::to_string(value));
    }
}

TEST(Compare, NamesAParticleThatOneEngineLost) {
  using Particles = std::vector<Particle>;
  EXPECT_EQ(frame_difference_after([](Particles& p) { p.erase(p.begin() + 1); }),
            "step 2, cell 0 (0 0 0), particle 1, presence: golden present, rtl missing");
  EXPECT_EQ(frame_difference_after([](Particles& p) { p.pop_back(); }),
            "step 2, cell 1 (1 0 0), particle 5, presence: golden present, rtl missing");
  EXPECT_EQ(frame_difference_after([](Particles& p) {
              p.push_back({9, 0, 1, {}, {}, {}});
            }),
            "step 2, cell 1 (1 0 0), particle 9, presence: golden missing, rtl present");
}

TEST(Compare, FindsFramesByStep) {
  const Trace trace = made_trace();
  EXPECT_EQ(frame_at(trace, 2), &trace.frames[1]);
  EXPECT_EQ(frame_at(trace, 1), nullptr);
}

}  // namespace
}  // namespace cuboct
