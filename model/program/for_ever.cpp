// SPDX-License-Identifier: MIT
#include "model/program/for_ever.h"

#include <map>
#include <optional>
#include <vector>

namespace cuboct {
namespace {

using Known = std::optional<double>;
using Truths = std::map<uint32_t, Known>;  // by number of a bond's field; none: unknown
constexpr size_t kMostTruths = 8;

// Of each node its value, where these truths alone say it.
std::vector<Known> known(const RealGraph& graph, const Truths& truths) {
  std::vector<Known> values;
  for (const RealNode& node : graph.nodes()) {
    const auto of = [&](size_t k) { return values[node.of[k]]; };
    const auto is = [&](size_t k, bool truth) { return of(k) && (*of(k) != 0) == truth; };
    Known value;
    if (node.op == RealOp::constant) {
      value = node.value;
    } else if (node.op == RealOp::input) {
      const auto at = truths.find(node.input.index);
      if (node.input.source == RealSource::made) value = 1;
      if (node.input.source == RealSource::bond_field && at != truths.end()) value = at->second;
    } else if (node.op == RealOp::both && (is(0, false) || is(1, false))) {
      value = 0;
    } else if (node.op == RealOp::either && (is(0, true) || is(1, true))) {
      value = 1;
    } else if (node.op == RealOp::select && of(0)) {
      value = is(0, true) ? of(1) : of(2);
    } else {
      bool all = true;
      for (size_t k = 0; k < static_cast<size_t>(arity(node.op)); ++k) all = all && of(k);
      const auto part = [&](size_t k) { return of(k).value_or(0); };
      if (all) value = applied(node, part(0), part(1), part(2));
    }
    values.push_back(value);
  }
  return values;
}

bool stays_broken(const RuleProgram& rule, const Truths& before) {
  Truths now = before;
  for (const ProgramRound& round : rule.rounds) {
    const std::vector<Known> values = known(round.pair, now);
    for (const NodeId when : round.when)
      if (values[when] != Known(0)) return false;
    for (const ProgramWrite& write : round.bonds)
      if (now.contains(write.number)) now[write.number] = values[write.node];
  }
  return now == before;
}

}  // namespace

bool broken_for_ever(const RuleProgram& rule) {
  if (!rule.broken_at) return false;
  std::vector<uint32_t> read;
  for (const RealNode& node : rule.broken.nodes())
    if (node.op == RealOp::input) read.push_back(node.input.index);
  for (const uint32_t number : read)
    for (const ProgramField& field : rule.bond)
      if (field.first <= number && number < field.first + field.numbers() && field.kind != Value::Kind::truth)
        return false;
  if (read.empty() || read.size() > kMostTruths) return false;
  for (uint32_t choice = 0; choice < (1u << read.size()); ++choice) {
    Truths truths;
    for (size_t k = 0; k < read.size(); ++k) truths[read[k]] = (choice >> k) & 1u;
    const Known broken = known(rule.broken, truths)[*rule.broken_at];
    if (broken == Known(1) && !stays_broken(rule, truths)) return false;
  }
  return true;
}

}  // namespace cuboct
