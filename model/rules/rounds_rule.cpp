// SPDX-License-Identifier: MIT
#include "model/rules/rounds_rule.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "model/base/error.h"
#include "model/base/parallel.h"

namespace cuboct {
namespace {

[[noreturn]] void refuse(const RoundsRule& rule, const std::string& who) {
  const size_t rounds = rule.declaration().rounds.size();
  throw InputError(fmt::format("the rule '{}' has {} round{} of its own, and {} knows the pair law alone",
                               rule.declaration().name, rounds, rounds == 1 ? "" : "s", who),
                   rule.text() != nullptr
                       ? "engines reference, golden, lattice, gpu, systemc and rtl run it; a force of r "
                         "along d, with 'core', is a pair law"
                       : "the reference engine runs it")
      .about({"rule.kind", "rule.file", "rule"});
}

}  // namespace

void run_rounds(RoundsTerms& terms, size_t rounds, size_t particles, bool keeps, int threads) {
  // Of a part where threads share them: rows differ in their work, parts are dealt out one by one.
  constexpr size_t kRows = 64;
  const size_t rows = threads < 2 ? std::max<size_t>(particles, 1) : kRows;
  const size_t parts = (particles + rows - 1) / rows;
  for (size_t round = 0; round < rounds; ++round) {
    for_each_part(parts, threads, [&](size_t part, int) {
      const size_t begin = part * rows, end = std::min(begin + rows, particles);
      terms.pair(round, begin, end, keeps);
      terms.finish(round, begin, end);
    });
    terms.end(round, keeps);
  }
}

bool has_reference_bonds(const Rule& rule) {
  return rule.rounds != nullptr && rule.rounds->declaration().bonds == BondRange::reference;
}

bool has_bond_memory(const Rule& rule) {
  return rule.rounds != nullptr && !rule.rounds->declaration().bond.empty();
}

bool has_memory(const Rule& rule) {
  return has_bond_memory(rule) || (rule.rounds != nullptr && !rule.rounds->declaration().kept.empty());
}

bool moves(const Rule& rule) { return rule.rounds == nullptr || rule.rounds->declaration().moves; }

Body with_bonds(const Rule& rule, Body body, const Body& start) {
  if (!has_reference_bonds(rule) && !has_memory(rule)) return body;
  body.bonds = start.bonds ? start.bonds : std::make_shared<BondState>(BondState{start.x, {}});
  return body;
}

void keep_bonds(Body& body, const RoundsTerms& terms) {
  if (!body.bonds) return;
  std::vector<uint64_t> kept = terms.memory();
  if (!kept.empty()) kept.insert(kept.begin(), terms.memory_hash());
  body.bonds = std::make_shared<BondState>(BondState{body.bonds->packed, std::move(kept)});
}

void recall_bonds(RoundsTerms& terms, const Body& body) {
  if (!body.bonds || body.bonds->kept.empty()) return;
  const std::vector<uint64_t>& kept = body.bonds->kept;
  if (kept.front() != terms.memory_hash())
    throw InputError(
        "the state was left by other bonds: its horizon, slits, unbreakable regions, critical "
        "stretch and damage width are not those of the rule here",
        "go on with the rule that left it")
        .about({"start.from", "rule"});
  terms.recall({kept.begin() + 1, kept.end()});
}

void Rule::refuse_pairs() const {
  if (rounds == nullptr) throw std::logic_error("a rule without law and rounds");
  refuse(*rounds, "what is asked for");
}

void refuse_rounds(const Rule& rule, const std::string& who) {
  if (rule.rounds != nullptr) refuse(*rule.rounds, who);
}

}  // namespace cuboct
