// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/rounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/error.h"

namespace cuboct::emu {
namespace {

void check_doubles(const graph::Graph& graph, const std::string& what) {
  const graph::Exactness exactness = graph::exactness_of(graph);
  if (exactness.doubles) return;
  throw InputError(fmt::format("{}: '{}' needs more bits than the vectors of the lattice engine hold", what,
                               label(graph, exactness.worst)),
                   "engine golden runs it")
      .about({"rule.file", "rule"});
}

}  // namespace

Rounds::Rounds(const graph::FixedProgram& program, const KernelRule& rule, const Lattice& lattice,
               const graph::BondRows* rows)
    : program_(program),
      rule_(rule),
      once_(rows == nullptr && std::ranges::all_of(program.rounds, PairPass::is_mutual)) {
  if (rows != nullptr) {
    // In a ring of three cells all are neighbours, and a partner is met two cells away.
    if (std::ranges::count(lattice.period(), 3) > 0)
      throw InputError("a box of three cells along an axis: bonds meet around it in golden alone",
                       "engine golden, or a longer box")
          .about({"box.cells", "box.size", "box"});
    bonds_ = {rows, &bond_numbers_, rule.cell, {}};
    for (size_t a = 0; a < 3; ++a) bonds_.period[a] = lattice.period()[a] * rule.cell;
    for (int k = 0; k < program.bond_numbers(); ++k) {
      bond_numbers_.emplace_back(rows->other.size());
      bonds_before_.emplace_back(rows->other.size());
    }
  }
  for (const graph::Round& round : program.rounds) {
    check_doubles(round.pair, "a pair of " + round.name);
    check_doubles(round.finish, "the finish of " + round.name);
  }
}

bool Rounds::knows_time() const {
  const auto reads_it = [](const graph::Graph& graph) {
    return std::ranges::any_of(graph.nodes, [](const graph::Node& node) {
      return node.op == graph::Op::input && node.source == graph::Source::step;
    });
  };
  return std::ranges::any_of(program_.rounds, [&](const graph::Round& round) {
    return reads_it(round.pair) || reads_it(round.finish);
  });
}

void Rounds::cut(size_t blocks, size_t room) {
  if (room > Partner::kMost)
    throw InputError(
        fmt::format("{} particles in one process: a rule of text lists up to {}", room, Partner::kMost),
        "a smaller body")
        .about({"rule.file", "rule"});
  parts_.resize(blocks);
  for (Part& part : parts_) {
    if (!part.pairs.empty()) continue;
    for (const graph::Round& round : program_.rounds) {
      part.pairs.push_back(std::make_unique<PairPass>(program_, round, once_));
      part.finishes.push_back(std::make_unique<FinishPass>(program_, round, rule_));
    }
  }
  sums_.clear();
  for (const graph::Round& round : program_.rounds) {
    auto& sums = sums_.emplace_back();
    for (const graph::Sum& sum : round.sums)
      for (size_t n = 0; n < sum.terms.size(); ++n) sums.emplace_back(room);
  }
  for (auto* arrays : {&moves_.v, &moves_.drift})
    for (auto& array : *arrays) array = PaddedArray<double>(room);
  if (!program_.motion.u.empty())
    for (auto& array : moves_.u) array = PaddedArray<double>(room);
}

void Rounds::build(size_t b, const Block& block, const Particles& particles, Search search) {
  parts_[b].list.build(block, particles, program_.position_frac, once_, std::move(search));
}

void Rounds::build(size_t b, const Block& block, const Particles& particles, const Index& index) {
  parts_[b].list.build(block, particles, index, *bonds_.rows);
}

void Rounds::take_bonds(const std::vector<int64_t>& bonds) {
  const size_t numbers = bond_numbers_.size();
  for (size_t k = 0; k < bonds.size(); ++k)
    bond_numbers_[k % numbers][k / numbers] = static_cast<double>(bonds[k]);
}

std::vector<int64_t> Rounds::whole(const BondNumbers& numbers) {
  std::vector<int64_t> bonds;
  for (size_t b = 0; b < (numbers.empty() ? 0 : numbers[0].size()); ++b)
    for (const auto& values : numbers) bonds.push_back(static_cast<int64_t>(values[b]));
  return bonds;
}

void Rounds::keep_bonds() {
  for (size_t k = 0; k < bond_numbers_.size(); ++k)
    std::copy_n(bond_numbers_[k].data(), bond_numbers_[k].size(), bonds_before_[k].data());
}

void Rounds::prune(size_t b, const Block& block, const Particles& particles, double reach) {
  parts_[b].list.prune(block, particles, reach);
}

bool Rounds::meet(size_t k, size_t b, const Block& block, const Particles& particles, const Active& active,
                  uint64_t step) {
  return parts_[b].pairs[k]->run(particles, parts_[b].list, block, active, step, sums_[k], bonds_);
}

bool Rounds::finish(size_t k, size_t b, const Block& block, Particles& particles, const Active& active,
                    uint64_t step) {
  return parts_[b].finishes[k]->run(particles, block, active, step, sums_[k], moves_);
}

void Rounds::move(Block& block, Particles& particles, const Active& active) {
  for (uint32_t p = block.begin; p < block.end; ++p) {
    if (active.awake != nullptr && active.awake[particles.cell[p]] == 0) continue;
    Crossing crossing{p, {}};
    double speed2 = 0;
    if (move(particles, p, crossing, speed2) && active.changed != nullptr) active.mark(particles.cell[p]);
    block.fastest2 = std::max(block.fastest2, speed2);
    if (crossing.away != std::array<int8_t, 3>{}) block.crossings.push_back(crossing);
  }
}

// Whether something changed.
bool Rounds::move(Particles& particles, uint32_t p, Crossing& crossing, double& speed2) const {
  bool changed = false;
  for (size_t a = 0; a < program_.motion.v.size(); ++a) {
    const double before = particles.x[a][p], v = moves_.v[a][p];
    // The drift is exact: what the residue and the drift make together of visible units goes to x.
    const double exact = particles.residue[a][p] + moves_.drift[a][p];
    const double whole = std::floor(exact * rule_.inverse_guard);
    const double after = before + whole;
    const auto residue = static_cast<int32_t>(exact - whole * rule_.guard);
    changed |= after != before || residue != particles.residue[a][p] || v != particles.v[a][p];
    crossing.away[a] =
        static_cast<int8_t>(std::floor(after * rule_.inverse_cell) - std::floor(before * rule_.inverse_cell));
    particles.x[a][p] = after;
    particles.residue[a][p] = residue;
    particles.v[a][p] = v;
    if (particles.u[0].size() > 0) {
      const double u = program_.motion.u.empty() ? 0 : moves_.u[a][p];
      changed |= particles.u[a][p] != u;
      particles.u[a][p] = u;
    }
    speed2 += v * v;
  }
  return changed;
}

}  // namespace cuboct::emu
