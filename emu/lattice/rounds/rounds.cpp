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
    : program_(program), rule_(rule), once_(std::ranges::all_of(program.rounds, is_mutual)) {
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
  moves_.axes = static_cast<int>(program_.motion.v.size());
  for (auto* arrays : {&moves_.v, &moves_.drift})
    for (auto& array : *arrays) array = PaddedArray<double>(room);
  if (!program_.motion.u.empty())
    for (auto& array : moves_.u) array = PaddedArray<double>(room);
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

void Rounds::compile(const std::string& simd, const std::string& directory) {
  auto library = std::make_unique<CodeLibrary>(program_, once_, simd, directory);
  std::vector<CodePass> code;
  for (size_t k = 0; k < program_.rounds.size(); ++k) {
    code.emplace_back(*library, program_, space_, k, once_);
    PairPass pass(program_, program_.rounds[k], space_, once_);
    prove(code.back(), pass, program_, program_.rounds[k], space_, once_);
  }
  library_ = std::move(library);
  code_ = std::move(code);
}

bool Rounds::meet(size_t k, size_t b, const Scope& scope) {
  if (parts_[b].lost) return false;
  if (compiled()) return code_[k].run(scope, parts_[b].bonds, parts_[b].sums[k]);
  return parts_[b].pairs[k]->run(scope, parts_[b].bonds, parts_[b].sums[k]);
}

bool Rounds::finish(size_t k, size_t b, const Block& block, Particles& particles, const Active& active,
                    uint64_t step) {
  return parts_[b].finishes[k]->run(particles, block, active, step, parts_[b].sums[k], moves_);
}

void Rounds::move(Block& block, Particles& particles, const Active& active) {
  move_block(rule_, moves_, active, particles, block);
}

}  // namespace cuboct::emu
