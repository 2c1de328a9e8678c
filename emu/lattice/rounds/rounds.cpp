// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/rounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "emu/lattice/code/proof.h"
#include "model/base/error.h"
#include "model/contract/program_run.h"

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
    : program_(program), rule_(rule), once_(is_mutual(program)) {
  if (rows != nullptr) {
    space_ = {rows, rule.cell, {}};
    for (size_t a = 0; a < 3; ++a) space_.period[a] = lattice.period()[a] * rule.cell;
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

bool Rounds::reads_velocities() const {
  return std::ranges::any_of(program_.rounds, [](const graph::Round& round) {
    return std::ranges::any_of(round.pair.nodes, [](const graph::Node& node) {
      return node.op == graph::Op::input && node.source == graph::Source::other_v;
    });
  });
}

std::vector<size_t> Rounds::read_of_others(size_t k) const {
  std::set<size_t> numbers;
  for (const graph::Node& node : program_.rounds[k].pair.nodes)
    if (node.op == graph::Op::input && node.source == graph::Source::other_field)
      numbers.insert(static_cast<size_t>(program_.place(node.index) + node.axis));
  return {numbers.begin(), numbers.end()};
}

void Rounds::cut(const std::vector<Block>& blocks, size_t room) {
  parts_.resize(blocks.size());
  for (size_t b = 0; b < blocks.size(); ++b) {
    Part& part = parts_[b];
    part.sums.resize(program_.rounds.size());
    for (size_t k = 0; k < program_.rounds.size(); ++k) {
      const graph::Round& round = program_.rounds[k];
      if (part.pairs.size() == k) {
        part.pairs.push_back(std::make_unique<PairPass>(program_, round, space_, once_));
        part.finishes.push_back(std::make_unique<FinishPass>(program_, round, rule_));
      }
      part.sums[k].clear();
      for (int n = 0; n < round.numbers(); ++n) part.sums[k].emplace_back(blocks[b].end - blocks[b].begin);
    }
  }
  moves_ = compiled() ? Moves() : moves_for(program_, room);
}

void Rounds::list_bonds(size_t b, const Block& block, const Particles& particles, const Index& index) {
  BondList& list = parts_[b].bonds;
  const auto numbers = static_cast<size_t>(program_.bond_numbers());
  list.build(block, particles, index, space_, once_, program_.bond_numbers());
  for (size_t slot = 0; slot < list.bond.size(); ++slot)
    for (size_t k = 0; k < numbers; ++k)
      if (list.bond[slot] != BondList::kNoBond)
        list.numbers[k][slot] = static_cast<double>(bonds_[list.bond[slot] * numbers + k]);
  parts_[b].lost = std::ranges::any_of(list.far, [&](uint64_t bond) {
    const graph::BondRows& rows = *space_.rows;
    return !is_broken(program_, {.bond = bonds_.data() + bond * numbers,
                                 .bond_constants = rows.constants.data() +
                                                   rows.kind[bond] * program_.bond_constants.size()});
  });
}

std::vector<int64_t> Rounds::whole(std::vector<PaddedArray<double>> BondList::*values) const {
  std::vector<int64_t> bonds = bonds_;
  const auto numbers = static_cast<size_t>(program_.bond_numbers());
  for (const Part& part : parts_)
    for (size_t slot = 0; slot < part.bonds.bond.size(); ++slot)
      for (const uint64_t bond : {part.bonds.bond[slot], part.bonds.twin[slot]})
        for (size_t k = 0; k < numbers; ++k)
          if (bond != BondList::kNoBond)
            bonds[bond * numbers + k] = static_cast<int64_t>((part.bonds.*values)[k][slot]);
  return bonds;
}

void Rounds::keep_bonds() {
  for (Part& part : parts_)
    for (size_t k = 0; k < part.bonds.numbers.size(); ++k)
      std::copy_n(part.bonds.numbers[k].data(), part.bonds.numbers[k].size(), part.bonds.before[k].data());
}

bool Rounds::has_kept_code(const std::string& simd) const { return is_kept(program_, once_, simd); }

void Rounds::compile(const std::string& simd, const std::string& directory) {
  auto library = std::make_unique<CodeLibrary>(program_, once_, simd, directory);
  std::vector<CodePass> code;
  std::vector<FinishCodePass> finishes;
  for (size_t k = 0; k < program_.rounds.size(); ++k) {
    const graph::Round& round = program_.rounds[k];
    code.emplace_back(*library, program_, space_, k, once_);
    PairPass pass(program_, round, space_, once_);
    prove(code.back(), pass, program_, round, space_, once_);
    finishes.emplace_back(*library, rule_, k);
    prove(finishes.back(), program_, rule_, k);
  }
  library_ = std::move(library);
  code_ = std::move(code);
  finish_code_ = std::move(finishes);
  moves_ = {};
}

bool Rounds::meet(size_t k, size_t b, const Scope& scope) {
  Part& part = parts_[b];
  if (part.lost) return false;
  if (!compiled()) return part.pairs[k]->run(scope, part.bonds, part.sums[k]);
  if (k == 0) part.wanted = WantedGroups(scope.particles, scope.block, scope.active);
  return code_[k].run({scope, part.wanted}, part.bonds, part.sums[k]);
}

bool Rounds::finish(size_t k, size_t b, Block& block, Particles& particles, const Active& active,
                    uint64_t step) {
  Part& part = parts_[b];
  if (!compiled()) return part.finishes[k]->run(particles, block, active, step, part.sums[k], moves_);
  const FinishCodePass& code = finish_code_[k];
  const FinishCodePass::Step of{active, step, part.wanted, part.sums[k]};
  return k + 1 < program_.rounds.size() ? code.run(particles, block, of) : code.fits(particles, block, of);
}

void Rounds::move(size_t b, Block& block, Particles& particles, const Active& active, uint64_t step) {
  const Part& part = parts_[b];
  if (compiled())
    finish_code_.back().move(particles, block, {active, step, part.wanted, part.sums.back()});
  else
    move_block(rule_, moves_, active, particles, block);
}

}  // namespace cuboct::emu
