// SPDX-License-Identifier: MIT
// The pair law's program makes what pair_kick and finish make: values, faults and numbers.
#include "model/contract/pair_program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "model/contract/program_run.h"
#include "model/graph/parity.h"
#include "tests/graph/random_rule.h"

namespace cuboct {
namespace {

using graph::LaneFault;
using graph::Parity;
using test::Dice;

constexpr int kCapacity = 6;
constexpr uint64_t kRules = 80;

Particle random_particle(Dice& dice, const FixedRule& rule, uint32_t id) {
  Particle p;
  p.id = id;
  p.type = static_cast<uint8_t>(dice.draw(0, static_cast<int>(rule.types.size()) - 1));
  const int narrow = dice.chance(50) ? 0 : rule.widths.velocity_bits - 4;  // so that no pair is too fast
  for (size_t a = 0; a < static_cast<size_t>(rule.axes); ++a) {
    p.x[a] = static_cast<int64_t>(dice.bits(rule.widths.velocity_frac()));
    p.v[a] = test::within_bits(dice, rule.widths.velocity_bits - narrow);
    p.u[a] = test::within_bits(dice, rule.widths.displacement_bits);
  }
  return p;
}

struct Partners {
  Particle own;
  std::vector<Particle> particles;
  std::vector<Seen> seen;
};

// Near and far ones, in the cells around.
Partners random_partners(Dice& dice, const FixedRule& rule) {
  Partners all;
  all.own = random_particle(dice, rule, 0);
  for (uint32_t id = 1; id < 27 * kCapacity; ++id) all.particles.push_back(random_particle(dice, rule, id));
  for (const Particle& p : all.particles) {
    all.seen.push_back({&p, visible(rule, p.x)});
    for (size_t a = 0; a < static_cast<size_t>(rule.axes); ++a)
      if (dice.chance(60))
        all.seen.back().x[a] =
            visible(rule, all.own.x)[a] + test::within_bits(dice, rule.widths.position_frac);
      else
        all.seen.back().x[a] += int64_t{dice.draw(-1, 1)} << rule.widths.position_frac;
  }
  return all;
}

std::string at(uint64_t seed) { return "seed " + std::to_string(seed); }

TEST(PairProgram, MakesOfEachPairWhatPairKickMakes) {
  size_t inside = 0;
  std::map<Fault, size_t> faults;
  for (uint64_t seed = 1; seed <= kRules; ++seed) {
    const FixedRule rule = test::random_rule(seed);
    const graph::FixedProgram program = pair_program(rule, kCapacity);
    PairRun run(program, program.rounds[0], 0);
    Dice dice(seed);
    const Partners all = random_partners(dice, rule);
    const Seen own{&all.own, visible(rule, all.own.x)};
    Int3 total{};
    std::vector<std::pair<Fault, int64_t>> expected, met;
    for (const Seen& other : all.seen) {
      const Particle &i = all.own, &j = *other.particle;
      const PairResult pair = pair_kick(rule, own.x, i.v, i.type, other.x, j.v, j.type);
      Int3 kick{};
      run.add(own, {&other, 1}, std::span(kick).first(static_cast<size_t>(rule.axes)));
      ASSERT_EQ(kick, pair.kick) << at(seed) << ", partner " << j.id;
      const LaneFault first = run.faults().empty() ? LaneFault{} : run.faults()[0];
      ASSERT_EQ(first.fault, pair.fault) << at(seed) << ", partner " << j.id;
      ASSERT_EQ(first.number, pair.number) << at(seed) << ", partner " << j.id;
      for (size_t a = 0; a < 3; ++a) total[a] += kick[a];
      if (pair.fault != Fault::none) expected.emplace_back(pair.fault, pair.number);
      inside += pair.inside, ++faults[pair.fault];
    }
    Int3 sum{};
    run.add(own, all.seen, std::span(sum).first(static_cast<size_t>(rule.axes)));
    ASSERT_EQ(sum, total) << at(seed);
    for (const LaneFault& fault : run.faults()) met.emplace_back(fault.fault, fault.number);
    std::sort(met.begin(), met.end()), std::sort(expected.begin(), expected.end());
    ASSERT_EQ(met, expected) << at(seed);
  }
  EXPECT_GT(inside, 2000u);
  EXPECT_GT(faults[Fault::relative_velocity], 200u);
  EXPECT_GT(faults[Fault::strength], 50u);
}

TEST(PairProgram, MakesOfEachParticleWhatFinishMakes) {
  std::map<Fault, size_t> faults;
  for (uint64_t seed = 1; seed <= kRules; ++seed) {
    const FixedRule rule = test::random_rule(seed);
    const graph::FixedProgram program = pair_program(rule, kCapacity);
    FinishRun run(program, program.rounds[0], 0);
    Dice dice(seed);
    for (uint32_t id = 0; id < 100; ++id) {
      const Particle p = random_particle(dice, rule, id);
      const Seen seen{&p};
      Int3 sum{};
      for (size_t a = 0; a < static_cast<size_t>(rule.axes); ++a) {
        const int term = program.rounds[0].sums[0].terms[a];
        const graph::Interval range =
            graph::summed(program.rounds[0].pair.nodes[static_cast<size_t>(term)].range, program.partners);
        sum[a] = std::clamp(test::within_bits(dice, dice.draw(1, rule.widths.sum_bits + 1)), range.low,
                            range.high);
      }
      const FinishResult result = finish(rule, sum, p.x, p.v, p.u, p.type);
      run.run({&seen, 1}, std::span(sum).first(static_cast<size_t>(rule.axes)));
      for (size_t a = 0; a < static_cast<size_t>(rule.axes); ++a) {
        ASSERT_EQ(run.value(program.motion.v[a], 0), result.v[a]) << at(seed) << ", particle " << id;
        ASSERT_EQ(p.x[a] + run.value(program.motion.drift[a], 0), result.x[a]) << at(seed);
        if (rule.pd) {
          ASSERT_EQ(run.value(program.motion.u[a], 0), result.u[a]) << at(seed);
        }
      }
      const LaneFault first = run.faults().empty() ? LaneFault{} : run.faults()[0];
      ASSERT_EQ(first.fault, result.fault) << at(seed) << ", particle " << id;
      ASSERT_EQ(first.number, result.number) << at(seed) << ", particle " << id;
      ++faults[result.fault];
    }
  }
  for (const Fault fault : {Fault::none, Fault::sum, Fault::displacement, Fault::velocity})
    EXPECT_GT(faults[fault], 30u) << to_string(fault);
}

TEST(PairProgram, IsOddWhereTypesMayBeSwapped) {
  for (uint64_t seed = 1; seed <= kRules; ++seed) {
    FixedRule rule = test::random_rule(seed);
    const auto force_parity = [&](size_t axis) {
      const graph::FixedProgram program = pair_program(rule, kCapacity);
      const graph::Round& round = program.rounds[0];
      const std::vector<Parity> parities = graph::parities_of(round.pair);
      EXPECT_EQ(parities[static_cast<size_t>(round.when)], Parity::even) << at(seed);
      return parities[static_cast<size_t>(round.sums[0].terms[axis])];
    };
    for (size_t a = 0; a < static_cast<size_t>(rule.axes); ++a)
      EXPECT_TRUE(graph::is_odd(force_parity(a))) << at(seed);
    if (!rule.scaled || rule.types.size() < 2 || graph::is_even(force_parity(0))) continue;
    rule.scale[0][1] = std::abs(rule.scale[0][1]) / 2 + 1, rule.scale[1][0] = rule.scale[0][1] + 1;
    EXPECT_FALSE(graph::is_odd(force_parity(0))) << at(seed);
  }
}

}  // namespace
}  // namespace cuboct
