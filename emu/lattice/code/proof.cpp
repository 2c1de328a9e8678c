// SPDX-License-Identifier: MIT
#include "emu/lattice/code/proof.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <type_traits>

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
      fill(particles.v[a], [&] { return scaled(program.velocity); });
      if (!program.motion.u.empty()) fill(particles.u[a], [&] { return scaled(program.displacement); });
    }
    fill(particles.type, [&] { return whole(0, program.types - 1); });
    if (whole(0, 1) == 1) fill(particles.id, [&] { return whole(0, 1'000'000); });
    for (auto& shift : particles.shift)
      for (double& along : shift) along = static_cast<double>(whole(-1, 1) * (cell / 8));
    particles.shift[kNoShift] = {};
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
    if (space.rows != nullptr && !space.rows->kind.empty())
      fill_bonds(program, space, once);
    else
      fill_list(list_.entries, list_.groups);
  }
  const Particles& particles() const { return particles_; }
  const PairList& list() const { return list_; }
  const BondList& bonds() const { return bonds_; }

 private:
  template <typename Entries>
  void fill_list(Entries& entries, std::vector<EntryGroup>& groups) {
    for (uint32_t g = 0; g < kParticles / kGroup; ++g) {
      groups.push_back({static_cast<uint32_t>(entries.size()), kEntriesOfGroup, kEntriesOfGroup});
      for (uint32_t e = 0; e < kEntriesOfGroup; ++e)
        entries.push_back({static_cast<int32_t>(random_.whole(0, kParticles - kGroup)),
                           static_cast<uint8_t>(random_.whole(0, 255)),
                           static_cast<uint8_t>(random_.whole(0, 1) == 1 ? kNoShift : random_.whole(0, 26))});
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
  PairList list_;
  BondList bonds_;
};

bool same(const PaddedArray<double>& a, const PaddedArray<double>& b) {
  return std::equal(a.data(), a.data() + a.size(), b.data());
}
bool same(const std::vector<PaddedArray<double>>& a, const std::vector<PaddedArray<double>>& b) {
  return std::ranges::equal(a, b, [](const auto& one, const auto& other) { return same(one, other); });
}

BondList copy_of(const BondList& bonds) {
  BondList copy;
  copy.entries = bonds.entries, copy.both = bonds.both, copy.own = bonds.own;
  copy.kind = bonds.kind.copy();
  for (const auto& numbers : bonds.numbers) copy.numbers.push_back(numbers.copy());
  return copy;
}

// Of `count` particles from `first` on.
Particles copy_of(const Particles& particles, uint32_t first, uint32_t count) {
  const auto some = [&](const auto& from) {
    auto to = std::decay_t<decltype(from)>(from.size() > 0 ? count : 0);
    if (from.size() > 0) std::copy_n(from.data() + first, count, to.data());
    return to;
  };
  Particles copy;
  for (size_t a = 0; a < 3; ++a) {
    copy.x[a] = some(particles.x[a]), copy.v[a] = some(particles.v[a]);
    copy.u[a] = some(particles.u[a]), copy.residue[a] = some(particles.residue[a]);
  }
  for (const auto& field : particles.fields) copy.fields.push_back(some(field));
  copy.type = some(particles.type), copy.id = some(particles.id);
  copy.shift = particles.shift;
  return copy;
}

bool same(const Particles& a, const Particles& b) {
  for (size_t k = 0; k < 3; ++k)
    if (!same(a.x[k], b.x[k]) || !same(a.v[k], b.v[k]) || !same(a.u[k], b.u[k]) ||
        !std::equal(a.residue[k].data(), a.residue[k].data() + a.residue[k].size(), b.residue[k].data()))
      return false;
  return same(a.fields, b.fields);
}

// A ring of sums, as kernel_rule.h has them.
Sums sums_for(const graph::Round& round) {
  Sums sums;
  for (int n = 0; n < round.numbers(); ++n) sums.emplace_back(kParticles, kMagic);
  return sums;
}
// What overhangs the end belongs to its beginning.
void fold(Sums& sums) {
  for (auto& sum : sums)
    for (uint32_t l = 0; l < kGroup; ++l) sum[l] += sum[kParticles + l] - kMagic;
}

[[noreturn]] void distrust(const std::string& what) {
  throw InputError("the C++ compiler makes other numbers of " + what + " than the rule's graph says",
                   "--rule-code interpreted, or another compiler (CXX)");
}

// Pairs by one of both ways, and whom they ask and tell.
class PairTrial {
 public:
  PairTrial(const RoundCode& code, size_t round, const RandomPairs& random, PairPass* interpreter)
      : code_(code),
        round_(round),
        interpreter_(interpreter),
        particles_(copy_of(random.particles(), 0, kParticles)),
        bonds_(copy_of(random.bonds())),
        sums_(sums_for(code.program.rounds[round])) {
    block_.begin = 0, block_.end = kParticles, block_.inside = random.list();
    for (uint32_t g = 0; g < kParticles / kGroup; ++g) {
      all_groups_.push_back(g), wanted_.push_back(g % 3 != 0);
      if (g % 3 != 1) chosen_.push_back(g);
    }
  }

  void run(uint64_t step) {
    const Active active;
    const RoundStep of{particles_, block_, active, step};
    const Jobs jobs(of, code_.rule, code_.library->numbers(), bonds_);
    Job job = jobs.pairs();
    const std::vector<double*> sums = pointers(sums_);
    job.sums = sums.data(), job.mask = kParticles - 1;
    job.bond_constants = code_.constants.data();
    job.bond_constant_count = static_cast<int64_t>(code_.program.bond_constants.size());
    job.owner = this, job.meet = meet, job.misfit = misfit;
    job.count = kParticles / kGroup;
    const bool bonded = code_.program.bonded;
    job.entries = bonded ? bonds_.entries.data() : block_.inside.entries.data();
    job.groups = bonded ? bonds_.own.data() : block_.inside.groups.data();
    job.group_of = all_groups_.data(), job.wanted = wanted_.data();
    meet(Ends::own, job);
    job.group_of = nullptr, job.wanted = nullptr;
    if (step % 2 == 1) job.chosen = chosen_.data(), job.count = static_cast<uint32_t>(chosen_.size());
    if (code_.once) {
      if (bonded) job.groups = bonds_.both.data();
      meet(Ends::both, job);
    } else if (!bonded) {
      for (const Ends ends : {Ends::own, Ends::other}) meet(ends, job);
    }
    fold(sums_);
  }

  bool agrees(const PairTrial& other) const {
    return same(sums_, other.sums_) && same(bonds_.numbers, other.bonds_.numbers) &&
           misfits_ == other.misfits_ && lost_ == other.lost_;
  }

 private:
  void meet(Ends ends, const Job& job) {
    interpreter_ != nullptr ? interpreter_->run(job, ends) : code_.library->meet(round_, ends)(job);
  }
  static bool meet(void* owner, uint32_t own, uint32_t, uint64_t slot, double apart[3]) {
    PairTrial& of = *static_cast<PairTrial*>(owner);
    std::array<double, 3> ends{apart[0], apart[1], apart[2]};
    const auto& x = of.particles_.x;
    const bool meets = of.code_.space.meets({x[0][own], x[1][own], x[2][own]}, ends);
    std::ranges::copy(ends, apart);
    of.lost_ += !meets && !of.bonds_.is_broken(of.code_.program, of.code_.space, slot);
    return meets;
  }
  // The interpreter tells some that fit, too.
  static void misfit(void* owner, uint32_t, uint32_t, const Entry&, uint64_t) {
    static_cast<PairTrial*>(owner)->misfits_ = true;
  }

  const RoundCode& code_;
  size_t round_;
  PairPass* interpreter_;
  Particles particles_;
  Block block_;
  BondList bonds_;
  Sums sums_;
  std::vector<uint32_t> all_groups_, chosen_;
  std::vector<uint8_t> wanted_;
  bool misfits_ = false;
  int lost_ = 0;
};

// The finish of one group by one of both ways, and what it tells.
class FinishTrial {
 public:
  FinishTrial(const RoundCode& code, size_t round, const Particles& particles, uint32_t group,
              FinishPass* interpreter)
      : code_(code),
        round_(round),
        particles_(copy_of(particles, group * kGroup, kGroup)),
        interpreter_(interpreter) {
    block_.begin = 0, block_.end = kGroup;
    particles_.cell = kCells;
  }

  // Lane l is awake where `awake` has a 1 at l; null: all.
  void run(const std::vector<double*>& sums, const uint8_t* awake, uint64_t number) {
    const Active active{.awake = awake};
    const RoundStep step{particles_, block_, active, number};
    const Jobs jobs(step, code_.rule, code_.library->numbers(), none_);
    FinishJob job = jobs.finish();
    job.sums = sums.data(), job.mask = kGroup - 1;
    job.count = 1;
    job.owner = this;
    job.changed = [](void* owner, uint32_t p) { static_cast<FinishTrial*>(owner)->changed_.push_back(p); };
    job.crossed = [](void* owner, uint32_t p, const int8_t away[3]) {
      static_cast<FinishTrial*>(owner)->crossings_.push_back({p, away[0], away[1], away[2]});
    };
    job.misfit = [](void* owner, uint32_t, uint32_t) { static_cast<FinishTrial*>(owner)->fits_ = false; };
    interpreter_ != nullptr ? interpreter_->run(job) : code_.library->finish(round_)(job);
  }

  bool fits() const { return fits_; }
  // Squares of speeds are no whole numbers that doubles hold.
  bool agrees(const FinishTrial& other) const {
    if (!fits_ || !other.fits_) return fits_ == other.fits_;
    return same(particles_, other.particles_) && changed_ == other.changed_ &&
           crossings_ == other.crossings_ &&
           std::abs(block_.fastest2 - other.block_.fastest2) <= 1e-12 * other.block_.fastest2;
  }

 private:
  static constexpr uint32_t kCells[2 * kGroup] = {0, 1, 2, 3, 4, 5, 6, 7};

  const RoundCode& code_;
  size_t round_;
  Particles particles_;
  FinishPass* interpreter_;
  Block block_;
  BondList none_;
  bool fits_ = true;
  std::vector<uint32_t> changed_;
  std::vector<std::array<int64_t, 4>> crossings_;
};

void prove_pairs(const RoundCode& code, size_t round) {
  PairPass pass(code.program, code.program.rounds[round]);
  for (int batch = 0; batch < kBatches; ++batch) {
    const RandomPairs random(code.program, code.space, code.once, static_cast<uint64_t>(batch) + 1);
    PairTrial compiled(code, round, random, nullptr), interpreted(code, round, random, &pass);
    compiled.run(static_cast<uint64_t>(batch)), interpreted.run(static_cast<uint64_t>(batch));
    if (!compiled.agrees(interpreted)) distrust("round '" + code.program.rounds[round].name + "'");
  }
}

std::vector<graph::Interval> ranges_of_sums(const graph::Round& round) {
  std::vector<graph::Interval> ranges(static_cast<size_t>(round.numbers()));
  for (const graph::Node& node : round.finish.nodes)
    if (node.op == graph::Op::input && node.source == graph::Source::sum)
      ranges[static_cast<size_t>(round.place(node.index) + node.axis)] = node.range;
  return ranges;
}

int prove_finish(const RoundCode& code, size_t round) {
  FinishPass pass(code.program, code.program.rounds[round]);
  const std::vector<graph::Interval> ranges = ranges_of_sums(code.program.rounds[round]);
  int fitted = 0;
  for (uint64_t batch = 0; batch < 4 * kBatches; ++batch) {
    RandomNumbers random(batch + 1000);
    const Particles particles = random.particles(code.program);
    Sums sums;
    for (size_t n = 0; n < ranges.size(); ++n) sums.emplace_back(kGroup, kMagic);
    const std::vector<double*> pointers_to_sums = pointers(sums);
    for (uint32_t group = 0; group < kParticles / kGroup; ++group) {
      for (size_t n = 0; n < ranges.size(); ++n)
        for (uint32_t l = 0; l < kGroup; ++l) sums[n][l] = kMagic + random.scaled(ranges[n]);
      // All are awake, most, or one, so that a group fits now and then.
      uint8_t awake[2 * kGroup] = {};
      for (uint32_t l = 0; l < kGroup; ++l) awake[l] = batch % 4 == 1 ? l % 3 != 0 : l == group % kGroup;
      FinishTrial compiled(code, round, particles, group, nullptr);
      FinishTrial interpreted(code, round, particles, group, &pass);
      for (FinishTrial* trial : {&compiled, &interpreted})
        trial->run(pointers_to_sums, batch % 4 == 0 ? nullptr : awake, batch);
      if (!compiled.agrees(interpreted))
        distrust("the finish of round '" + code.program.rounds[round].name + "'");
      fitted += compiled.fits();
    }
  }
  return fitted;
}

}  // namespace

int prove(const RoundCode& code, size_t round) {
  prove_pairs(code, round);
  return prove_finish(code, round);
}

}  // namespace cuboct::emu
