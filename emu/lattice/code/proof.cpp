// SPDX-License-Identifier: MIT
#include "emu/lattice/code/proof.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <type_traits>

#include "emu/lattice/rounds/finish_pass.h"
#include "model/base/error.h"

namespace cuboct::emu {
namespace {

constexpr uint32_t kParticles = 128, kEntriesOfGroup = 4;
constexpr int kBatches = 8;

// Numbers of a state that never was.
class RandomNumbers {
 public:
  explicit RandomNumbers(uint64_t seed) : random_(seed) {}
  int64_t whole(int64_t low, int64_t high) {
    return std::uniform_int_distribution<int64_t>(low, high)(random_);
  }
  // The ends of a range, zero, any, and half of all near its middle, where rules are at home.
  double number(graph::Interval range) {
    const int64_t middle = range.low / 2 + range.high / 2, wide = (range.high / 2 - range.low / 2) / 64;
    const int64_t near = whole(std::max(range.low, middle - wide), std::min(range.high, middle + wide));
    const int64_t choices[] = {range.low,
                               range.high,
                               std::clamp<int64_t>(0, range.low, range.high),
                               whole(range.low, range.high),
                               near,
                               near,
                               near,
                               near};
    return static_cast<double>(choices[whole(0, 7)]);
  }
  // As a rule, of any size between one and the range's.
  double scaled(graph::Interval range) {
    const double value = number(range);
    const double small = std::trunc(std::ldexp(value, -static_cast<int>(whole(0, 40))));
    return whole(0, 15) == 0
               ? value
               : std::clamp(small, static_cast<double>(range.low), static_cast<double>(range.high));
  }
  Particles particles(const graph::FixedProgram& program) {
    Particles particles;
    const int64_t cell = int64_t{1} << program.position_frac;
    const auto fill = [&](auto& to, const auto& value) {
      to = std::decay_t<decltype(to)>(kParticles);
      for (uint32_t p = 0; p < kParticles; ++p) to[p] = static_cast<std::decay_t<decltype(to[p])>>(value());
    };
    for (size_t a = 0; a < 3; ++a) {
      fill(particles.x[a], [&] { return whole(0, cell + cell / 4); });
      fill(particles.residue[a], [&] { return whole(0, (int64_t{1} << program.guard) - 1); });
      fill(particles.v[a], [&] { return number(program.velocity); });
      if (!program.motion.u.empty()) fill(particles.u[a], [&] { return number(program.displacement); });
    }
    fill(particles.type, [&] { return whole(0, program.types - 1); });
    for (const graph::Field& field : program.fields)
      for (int n = 0; n < field.numbers; ++n)
        fill(particles.fields.emplace_back(), [&] { return number(field.range); });
    return particles;
  }

 private:
  std::mt19937_64 random_;
};

// A state, and a list of pairs.
class RandomPairs {
 public:
  RandomPairs(const graph::FixedProgram& program, const BondSpace& space, bool once, uint64_t seed)
      : random_(seed), particles_(random_.particles(program)) {
    block_.begin = 0, block_.end = kParticles;
    if (space.rows != nullptr && !space.rows->kind.empty())
      fill_bonds(program, space, once);
    else
      fill_list(block_.inside.entries, block_.inside.groups);
  }
  const Particles& particles() const { return particles_; }
  const Block& block() const { return block_; }
  const BondList& bonds() const { return bonds_; }

 private:
  template <typename Entries>
  void fill_list(Entries& entries, std::vector<EntryGroup>& groups) {
    for (uint32_t g = 0; g < kParticles / kGroup; ++g) {
      groups.push_back({static_cast<uint32_t>(entries.size()), kEntriesOfGroup, kEntriesOfGroup});
      for (uint32_t e = 0; e < kEntriesOfGroup; ++e)
        entries.push_back({static_cast<int32_t>(random_.whole(0, kParticles - kGroup)),
                           static_cast<uint8_t>(random_.whole(0, 255)), kNoShift});
    }
  }
  void fill_bonds(const graph::FixedProgram& program, const BondSpace& space, bool once) {
    if (once) fill_list(bonds_.entries, bonds_.both);
    fill_list(bonds_.entries, bonds_.own);
    bonds_.both.resize(bonds_.own.size());
    const size_t slots = bonds_.entries.size() * kGroup;
    bonds_.kind = PaddedArray<uint32_t>(slots);
    const auto last = static_cast<int64_t>(space.rows->kind.size()) - 1;
    for (size_t s = 0; s < slots; ++s)
      bonds_.kind[s] = space.rows->kind[static_cast<size_t>(random_.whole(0, last))];
    for (const graph::Field& field : program.bonds)
      for (int n = 0; n < field.numbers; ++n) {
        auto& numbers = bonds_.numbers.emplace_back(slots);
        for (size_t s = 0; s < slots; ++s) numbers[s] = random_.number(field.range);
      }
  }

  RandomNumbers random_;
  Particles particles_;
  Block block_;
  BondList bonds_;
};

Sums sums_for(const graph::Round& round) {
  Sums sums;
  for (int n = 0; n < round.numbers(); ++n) sums.emplace_back(kParticles);
  return sums;
}

// `bias`: what is added to each of `b`.
bool same(const PaddedArray<double>& a, const PaddedArray<double>& b, double bias = 0) {
  for (size_t n = 0; n < a.size(); ++n)
    if (a[n] != b[n] - bias) return false;
  return true;
}
bool same(const std::vector<PaddedArray<double>>& a, const std::vector<PaddedArray<double>>& b,
          double bias = 0) {
  for (size_t k = 0; k < a.size(); ++k)
    if (!same(a[k], b[k], bias)) return false;
  return true;
}

BondList copy_of(const BondList& bonds) {
  BondList copy;
  copy.entries = bonds.entries, copy.both = bonds.both, copy.own = bonds.own;
  copy.kind = bonds.kind.copy();
  for (const auto& numbers : bonds.numbers) copy.numbers.push_back(numbers.copy());
  return copy;
}

Particles copy_of(const Particles& particles, const uint32_t* cell) {
  Particles copy;
  for (size_t a = 0; a < 3; ++a) {
    copy.x[a] = particles.x[a].copy(), copy.v[a] = particles.v[a].copy();
    copy.u[a] = particles.u[a].copy(), copy.residue[a] = particles.residue[a].copy();
  }
  for (const auto& field : particles.fields) copy.fields.push_back(field.copy());
  copy.type = particles.type.copy();
  copy.cell = cell;
  return copy;
}

bool same(const Particles& a, const Particles& b) {
  for (size_t k = 0; k < 3; ++k)
    if (!same(a.x[k], b.x[k]) || !same(a.v[k], b.v[k]) || !same(a.u[k], b.u[k]) ||
        !std::equal(a.residue[k].data(), a.residue[k].data() + kParticles, b.residue[k].data()))
      return false;
  return same(a.fields, b.fields);
}

bool same(const std::vector<Crossing>& a, const std::vector<Crossing>& b) {
  return std::ranges::equal(a, b, [](const Crossing& one, const Crossing& other) {
    return one.particle == other.particle && one.away == other.away;
  });
}

[[noreturn]] void distrust(const std::string& what) {
  throw InputError("the C++ compiler makes other numbers of " + what + " than the rule's graph says",
                   "--rule-code interpreted, or another compiler (CXX)");
}

// What both make of one group, whose particles fit or do not.
class FinishTrial {
 public:
  FinishTrial(const FinishCodePass& code, const graph::FixedProgram& program, const KernelRule& rule,
              size_t round)
      : code_(code),
        program_(program),
        rule_(rule),
        last_(round + 1 == program.rounds.size()),
        pass_(program, program.rounds[round], rule),
        moves_(moves_for(program, kParticles)) {
    only_.awake = {0};
  }

  bool agree(const Particles& particles, const uint8_t* awake, const Sums& sums, uint32_t group) {
    Particles mine = copy_of(particles, particles.cell), other = copy_of(particles, particles.cell);
    Block my_block, other_block;
    for (Block* block : {&my_block, &other_block})
      block->begin = group * kGroup, block->end = block->begin + kGroup;
    Sums of_group, biased;
    for (const auto& sum : sums) {
      of_group.emplace_back(size_t{kGroup}), biased.emplace_back(size_t{kGroup});
      for (uint32_t l = 0; l < kGroup; ++l) {
        of_group.back()[l] = sum[my_block.begin + l];
        biased.back()[l] = of_group.back()[l] + kMagic;
      }
    }
    std::vector<uint8_t> my_changes(kParticles), other_changes(kParticles);
    Active active, other_active;
    if (awake != nullptr) {
      active.awake = other_active.awake = awake;
      active.changed = my_changes.data(), other_active.changed = other_changes.data();
    }
    const FinishCodePass::Step step{active, group, only_, biased};
    const bool fits = last_ ? code_.fits(mine, my_block, step) : code_.run(mine, my_block, step);
    if (fits != pass_.run(other, other_block, other_active, group, of_group, moves_)) return false;
    if (!fits && last_) return true;  // nothing moves
    if (last_) {
      code_.move(mine, my_block, step);
      move_block(rule_, moves_, other_active, other, other_block);
    }
    return same(mine, other) && same(my_block.crossings, other_block.crossings) &&
           my_changes == other_changes &&
           std::abs(my_block.fastest2 - other_block.fastest2) <= 1e-12 * other_block.fastest2;
  }

 private:
  const FinishCodePass& code_;
  const graph::FixedProgram& program_;
  const KernelRule& rule_;
  bool last_;
  FinishPass pass_;
  Moves moves_;
  WantedGroups only_;  // of a block of one group
};

}  // namespace

void prove(const CodePass& code, PairPass& pass, const graph::FixedProgram& program,
           const graph::Round& round, const BondSpace& space, bool once) {
  const WantedGroups wanted;
  for (int batch = 0; batch < kBatches; ++batch) {
    const RandomPairs random(program, space, once, static_cast<uint64_t>(batch) + 1);
    const Active all;
    const Scope scope{random.particles(), random.block(), all, static_cast<uint64_t>(batch)};
    Sums mine = sums_for(round), other = sums_for(round);
    BondList bonds = copy_of(random.bonds()), other_bonds = copy_of(random.bonds());
    const bool fits = code.run({scope, wanted}, bonds, mine),
               should_fit = pass.run(scope, other_bonds, other);
    if (fits != should_fit || !same(other, mine, kMagic) || !same(bonds.numbers, other_bonds.numbers))
      distrust("round '" + round.name + "'");
  }
}

void prove(const FinishCodePass& code, const graph::FixedProgram& program, const KernelRule& rule,
           size_t round) {
  FinishTrial trial(code, program, rule, round);
  const graph::Round& of = program.rounds[round];
  std::vector<graph::Interval> ranges(static_cast<size_t>(of.numbers()));
  for (const graph::Node& node : of.finish.nodes)
    if (node.op == graph::Op::input && node.source == graph::Source::sum)
      ranges[static_cast<size_t>(of.place(node.index) + node.axis)] = node.range;
  // Every third is asleep in half of the batches.
  std::vector<uint32_t> cells;
  std::vector<uint8_t> awake(kParticles + 8);
  for (uint32_t p = 0; p < kParticles + kGroup; ++p)
    cells.push_back(p % kParticles), awake[p % kParticles] = p % 3 != 0;
  for (int batch = 0; batch < 4 * kBatches; ++batch) {
    RandomNumbers random(static_cast<uint64_t>(batch) + 1000);
    Particles particles = random.particles(program);
    particles.cell = cells.data();
    Sums sums;
    for (const graph::Interval& range : ranges) {
      auto& sum = sums.emplace_back(size_t{kParticles});
      for (uint32_t p = 0; p < kParticles; ++p) sum[p] = random.scaled(range);
    }
    for (uint32_t group = 0; group < kParticles / kGroup; ++group)
      if (!trial.agree(particles, batch % 2 == 1 ? awake.data() : nullptr, sums, group))
        distrust("the finish of round '" + of.name + "'");
  }
}

}  // namespace cuboct::emu
