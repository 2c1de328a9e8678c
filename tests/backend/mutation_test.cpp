// SPDX-License-Identifier: MIT
// The comparison must see a defect and name its place: each test breaks the machine in one way.
#include <gtest/gtest.h>

#include <map>

#include "emu/systemc/node.h"
#include "tests/backend/engines.h"
#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

// A native node whose inputs pass through a saboteur.
class Sabotaged : public emu::NodeModel {
 public:
  using Act = std::function<void(uint32_t node, emu::NodeInputs& in)>;
  Sabotaged(uint32_t node, std::unique_ptr<emu::NodeModel> inner, const Act& act)
      : node_(node), inner_(std::move(inner)), act_(act) {}
  void clock(const emu::NodeInputs& in, emu::NodeOutputs& out) override {
    emu::NodeInputs changed = in;
    act_(node_, changed);
    inner_->clock(changed, out);
  }
  std::string doing() const override { return inner_->doing(); }

 private:
  const uint32_t node_;
  std::unique_ptr<emu::NodeModel> inner_;
  const Act act_;
};

std::string sabotage(const Case& c, const Sabotaged::Act& act) {
  const emu::NodeFactory inner = emu::native_nodes(c.setup.plan);
  const auto factory = [&](uint32_t node, uint8_t has_link) {
    return std::make_unique<Sabotaged>(node, inner(node, has_link), act);
  };
  const GoldenRun golden = run_golden(c.setup, c.steps);
  return compare(c.setup.plan, golden,
                 run_loop_bench(c.setup.plan, c.setup.initial, keep_all(c.steps), factory, "sabotaged"))
      .difference;
}

std::string with_other_plan(const Case& c, const Plan& other) {
  return compare(c.setup.plan, run_golden(c.setup, c.steps),
                 run_loop_bench(other, c.setup.initial, keep_all(c.steps), emu::native_nodes(other), "other"))
      .difference;
}

TEST(Mutation, TheSabotagedNodeIsFaithfulWithoutSabotage) {
  EXPECT_EQ(sabotage(make_case("undamped_2x2x2"), [](uint32_t, emu::NodeInputs&) {}), "");
}

TEST(Mutation, ADroppedHaloRecord) {
  int beats = 0, dropped = 0;
  const std::string text = sabotage(make_case("undamped_2x2x2"), [&](uint32_t node, emu::NodeInputs& in) {
    if (node != 3 || !(in.valid & 1) || in.beat[0]->end || ++beats != 2) return;
    in.valid &= static_cast<uint8_t>(~1u);
    ++dropped;
  });
  EXPECT_EQ(dropped, 1);
  EXPECT_EQ(text.substr(0, 17), "step 1: particle ") << text;
}

// What becomes of a run in which `spoil` meets the first particle that migrates, at its face. Streams of a
// link alternate: halo, migrate, ... With these links a record is one beat.
template <class Spoil>
std::string sabotage_of_migrant(const Case& c, const Spoil& spoil) {
  std::map<std::pair<uint32_t, unsigned>, int> ends;
  int spoilt = 0;
  const std::string text = sabotage(c, [&](uint32_t node, emu::NodeInputs& in) {
    for (unsigned f = 0; f < kFaces; ++f) {
      if (!(in.valid >> f & 1)) continue;
      int& seen = ends[{node, f}];
      if (in.beat[f]->end)
        ++seen;
      else if (seen % 2 == 1 && spoilt++ == 0)
        spoil(in, f);
    }
  });
  EXPECT_GT(spoilt, 0);
  return text;
}

TEST(Mutation, ADroppedParticle) {
  EXPECT_EQ(sabotage_of_migrant(
                make_case("wide_links"),
                [](emu::NodeInputs& in, unsigned f) { in.valid &= static_cast<uint8_t>(~(1u << f)); }),
            "step 14: 31 particles, golden has 32");
}

// It comes without what its position has below X.
TEST(Mutation, AResidueLostInMigration) {
  const Case c = make_case("wide_links");
  const Plan& plan = c.setup.plan;
  const int bits = plan.rule.axes * plan.rule.widths.guard;
  const int lsb = plan.words.particle_bits - bits;  // it is the last field, as no type is held by force
  ASSERT_FALSE(plan.rule.pd);
  emu::Beat wrong;
  const std::string text = sabotage_of_migrant(c, [&](emu::NodeInputs& in, unsigned f) {
    EXPECT_NE(in.beat[f]->payload.get(lsb, bits), 0u);
    wrong = *in.beat[f];
    wrong.payload = wrong.payload.slice(0, lsb);
    in.beat[f] = &wrong;
  });
  EXPECT_EQ(text.substr(0, 18), "step 14: particle ") << text;
}

TEST(Mutation, ASwappedLink) {
  const std::string text = sabotage(make_case("lattice_3x2x1"), [](uint32_t node, emu::NodeInputs& in) {
    if (node != 1) return;  // in the middle of x: both faces have a link
    std::swap(in.beat[0], in.beat[1]);
    in.valid = static_cast<uint8_t>((in.valid & ~3u) | (in.valid >> 1 & 1u) | (in.valid << 1 & 2u));
  });
  EXPECT_EQ(text.substr(0, 17), "step 1: particle ") << text;
}

TEST(Mutation, AWrongBitOfABeat) {
  int changed = 0;
  emu::Beat wrong;
  const std::string text = sabotage(make_case("undamped_2x2x2"), [&](uint32_t node, emu::NodeInputs& in) {
    if (node != 0 || !(in.valid & 2) || in.beat[1]->end || changed > 0) return;
    wrong = *in.beat[1];
    wrong.payload.word[0] ^= 1u << 12;  // x, 2^-8 of a cell
    in.beat[1] = &wrong;
    ++changed;
  });
  EXPECT_EQ(changed, 1);
  EXPECT_EQ(text.substr(0, 17), "step 1: particle ") << text;
}

TEST(Mutation, AWrongTableWord) {
  const Case c = make_case("undamped_2x2x2");
  int seen = 0;
  Plan other = c.setup.plan;
  for (size_t k = 0; k < other.rule.force.c0.size(); ++k) other.rule.force.c0[k] += 1;
  EXPECT_EQ(with_other_plan(c, other).substr(0, 17), "step 1: particle ");
  // One word alone: each that the run reads is seen.
  for (size_t k = 64; k < 448; k += 32) {
    other = c.setup.plan;
    other.rule.force.c0[k] ^= 64;
    seen += !with_other_plan(c, other).empty();
  }
  EXPECT_GE(seen, 6);
}

// The same law, halved where every entry is even and with one bit less to shift out afterwards: the two
// differ only in where the interpolation rounds.
TEST(Mutation, AWrongRounding) {
  Case c = make_case("undamped_2x2x2");
  for (auto* column : {&c.setup.plan.rule.force.c0, &c.setup.plan.rule.force.c1})
    for (int32_t& w : *column) w &= ~1;
  Plan other = c.setup.plan;
  other.rule.kick_shift -= 1;
  for (auto* column : {&other.rule.force.c0, &other.rule.force.c1})
    for (int32_t& w : *column) w /= 2;
  EXPECT_EQ(with_other_plan(c, c.setup.plan), "");
  EXPECT_EQ(with_other_plan(c, other).substr(0, 17), "step 1: particle ");
}

TEST(Mutation, ACutLinkIsADeadlockThatNamesTheNodes) {
  int dropped = 0;
  try {
    sabotage(make_case("lattice_3x2x1"), [&](uint32_t node, emu::NodeInputs& in) {
      if (node != 1 || !(in.valid & 1)) return;
      in.valid &= static_cast<uint8_t>(~1u);
      ++dropped;
    });
    FAIL() << "no deadlock";
  } catch (const std::runtime_error& e) {
    const std::string text = e.what();
    EXPECT_EQ(text.substr(0, 28), "stuck: no node has begun or ") << text;
    EXPECT_NE(text.find("\n  node 1 (1,0,0): step 0, exchange_x: waits for the halo of -x"),
              std::string::npos)
        << text;
  }
  EXPECT_GT(dropped, 1);
}

TEST(Mutation, ALatePhaseIsSeen) {
  const Case c = make_case("undamped_2x2x2");
  Plan other = c.setup.plan;
  other.rounds[0].pipe += 1;
  const auto run = [&](const Plan& plan, const char* name) {
    return run_loop_bench(plan, c.setup.initial, keep_all(c.steps), emu::native_nodes(plan), name);
  };
  const auto right = run(c.setup.plan, "right"), late = run(other, "late");
  EXPECT_EQ(compare_cycles(right, run(c.setup.plan, "again")).difference, "");
  EXPECT_EQ(compare_cycles(right, late).difference.substr(0, 23), "step 0, node 0, force: ");
}

}  // namespace
}  // namespace cuboct::test
