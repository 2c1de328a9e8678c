// SPDX-License-Identifier: MIT
#include "emu/lattice/code/proof.h"

#include <algorithm>
#include <random>

#include "model/base/error.h"

namespace cuboct::emu {
namespace {

constexpr uint32_t kParticles = 128, kEntriesOfGroup = 4;
constexpr int kBatches = 8;

// A state that never was, and a list of pairs.
class RandomPairs {
 public:
  RandomPairs(const graph::FixedProgram& program, const BondSpace& space, bool once, uint64_t seed)
      : random_(seed) {
    fill_particles(program);
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
  void fill(PaddedArray<double>& to, graph::Interval range) {
    to = PaddedArray<double>(kParticles);
    for (uint32_t p = 0; p < kParticles; ++p) to[p] = number(range);
  }
  void fill_particles(const graph::FixedProgram& program) {
    const int64_t cell = int64_t{1} << program.position_frac;
    for (size_t a = 0; a < 3; ++a) {
      particles_.x[a] = PaddedArray<double>(kParticles);
      for (uint32_t p = 0; p < kParticles; ++p)
        particles_.x[a][p] = static_cast<double>(whole(0, cell + cell / 4));
      fill(particles_.v[a], program.velocity);
    }
    particles_.type = PaddedArray<uint8_t>(kParticles);
    for (uint32_t p = 0; p < kParticles; ++p)
      particles_.type[p] = static_cast<uint8_t>(whole(0, program.types - 1));
    for (const graph::Field& field : program.fields)
      for (int n = 0; n < field.numbers; ++n) fill(particles_.fields.emplace_back(), field.range);
  }
  template <typename Entries>
  void fill_list(Entries& entries, std::vector<EntryGroup>& groups) {
    for (uint32_t g = 0; g < kParticles / kGroup; ++g) {
      groups.push_back({static_cast<uint32_t>(entries.size()), kEntriesOfGroup, kEntriesOfGroup});
      for (uint32_t e = 0; e < kEntriesOfGroup; ++e)
        entries.push_back({static_cast<int32_t>(whole(0, kParticles - kGroup)),
                           static_cast<uint8_t>(whole(0, 255)), kNoShift});
    }
  }
  void fill_bonds(const graph::FixedProgram& program, const BondSpace& space, bool once) {
    if (once) fill_list(bonds_.entries, bonds_.both);
    fill_list(bonds_.entries, bonds_.own);
    bonds_.both.resize(bonds_.own.size());
    const size_t slots = bonds_.entries.size() * kGroup;
    bonds_.kind = PaddedArray<uint32_t>(slots);
    for (size_t s = 0; s < slots; ++s)
      bonds_.kind[s] =
          space.rows->kind[static_cast<size_t>(whole(0, static_cast<int64_t>(space.rows->kind.size()) - 1))];
    for (const graph::Field& field : program.bonds)
      for (int n = 0; n < field.numbers; ++n) {
        auto& numbers = bonds_.numbers.emplace_back(slots);
        for (size_t s = 0; s < slots; ++s) numbers[s] = number(field.range);
      }
  }

  std::mt19937_64 random_;
  Particles particles_;
  Block block_;
  BondList bonds_;
};

Sums sums_for(const graph::Round& round) {
  Sums sums;
  for (int n = 0; n < round.numbers(); ++n) sums.emplace_back(kParticles);
  return sums;
}

bool same(const std::vector<PaddedArray<double>>& a, const std::vector<PaddedArray<double>>& b) {
  for (size_t k = 0; k < a.size(); ++k)
    for (size_t n = 0; n < a[k].size(); ++n)
      if (a[k][n] != b[k][n]) return false;
  return true;
}

BondList copy_of(const BondList& bonds) {
  BondList copy;
  copy.entries = bonds.entries, copy.both = bonds.both, copy.own = bonds.own;
  copy.kind = bonds.kind.copy();
  for (const auto& numbers : bonds.numbers) copy.numbers.push_back(numbers.copy());
  return copy;
}

}  // namespace

void prove(const CodePass& code, PairPass& pass, const graph::FixedProgram& program,
           const graph::Round& round, const BondSpace& space, bool once) {
  for (int batch = 0; batch < kBatches; ++batch) {
    const RandomPairs random(program, space, once, static_cast<uint64_t>(batch) + 1);
    const Active all;
    const Scope scope{random.particles(), random.block(), all, static_cast<uint64_t>(batch)};
    Sums mine = sums_for(round), other = sums_for(round);
    BondList bonds = copy_of(random.bonds()), other_bonds = copy_of(random.bonds());
    const bool fits = code.run(scope, bonds, mine), should_fit = pass.run(scope, other_bonds, other);
    if (fits == should_fit && same(mine, other) && same(bonds.numbers, other_bonds.numbers)) continue;
    throw InputError(
        "the C++ compiler makes other numbers of round '" + round.name + "' than the rule's graph says",
        "--rule-code interpreted, or another compiler (CXX)");
  }
}

}  // namespace cuboct::emu
