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
    bond_constants_.assign(rows->constants.begin(), rows->constants.end());
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

void Rounds::cut(size_t blocks) { blocks_.resize(blocks); }

void Rounds::list_bonds(size_t b, const Block& block, const Particles& particles, const Index& index) {
  BondList& list = blocks_[b].bonds();
  const auto numbers = static_cast<size_t>(program_.bond_numbers());
  list.build(block, particles, index, space_, once_, program_.bond_numbers());
  for (size_t slot = 0; slot < list.bond.size(); ++slot)
    for (size_t k = 0; k < numbers; ++k)
      if (list.bond[slot] != BondList::kNoBond)
        list.numbers[k][slot] = static_cast<double>(bonds_[list.bond[slot] * numbers + k]);
  const graph::BondRows& rows = *space_.rows;
  blocks_[b].lost.clear();
  for (const uint64_t bond : list.far) {
    if (is_broken(program_, {.bond = bonds_.data() + bond * numbers,
                             .bond_constants =
                                 rows.constants.data() + rows.kind[bond] * program_.bond_constants.size()}))
      continue;
    const auto own = std::ranges::upper_bound(rows.first, bond) - rows.first.begin() - 1;
    blocks_[b].lost.emplace_back(index(static_cast<uint32_t>(own)), rows.other[bond]);
  }
}

std::vector<int64_t> Rounds::give_bonds() const {
  std::vector<int64_t> bonds = bonds_;
  const auto numbers = static_cast<size_t>(program_.bond_numbers());
  for (const BlockRounds& block : blocks_) {
    const BondList& list = block.bonds();
    for (size_t slot = 0; slot < list.bond.size(); ++slot)
      for (const uint64_t bond : {list.bond[slot], list.twin[slot]})
        for (size_t k = 0; k < numbers; ++k)
          if (bond != BondList::kNoBond)
            bonds[bond * numbers + k] = static_cast<int64_t>(list.numbers[k][slot]);
  }
  return bonds;
}

std::vector<Sums> Rounds::copy_bonds() const {
  std::vector<Sums> copy;
  for (const BlockRounds& block : blocks_) {
    copy.emplace_back();
    for (const auto& numbers : block.bonds().numbers) copy.back().push_back(numbers.copy());
  }
  return copy;
}

void Rounds::swap_bonds(std::vector<Sums>& with) {
  for (size_t b = 0; b < blocks_.size(); ++b) blocks_[b].bonds().numbers.swap(with[b]);
}

bool Rounds::has_kept_code(const std::string& simd) const { return is_kept(program_, once_, simd); }

void Rounds::compile(const std::string& simd, const std::string& directory) {
  auto library = std::make_unique<CodeLibrary>(program_, once_, simd, directory);
  const RoundCode code{program_, rule_, space_, once_, bond_constants_, library.get()};
  for (size_t k = 0; k < program_.rounds.size(); ++k) prove(code, k);
  library_ = std::move(library);
}

}  // namespace cuboct::emu
