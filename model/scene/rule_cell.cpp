// SPDX-License-Identifier: MIT
#include "model/scene/rule_cell.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/error.h"
#include "model/program/rule_program.h"
#include "model/rules/no_rest.h"

namespace cuboct {
namespace {

// Of each node of the graph whether it asks where a particle is, or draws what another image draws otherwise.
// `fields`: by number of the particles' fields, whether they do.
std::vector<bool> asking(const RealGraph& graph, const std::vector<bool>& fields) {
  std::vector<bool> asks;
  for (const RealNode& node : graph.nodes()) {
    bool any = false;
    if (node.op == RealOp::input) {
      const RealSource source = node.input.source;
      any = source == RealSource::position || source == RealSource::noise ||
            source == RealSource::own_region || source == RealSource::other_region ||
            ((source == RealSource::own_field || source == RealSource::other_field) &&
             fields[node.input.index]);
    }
    for (size_t k = 0; k < static_cast<size_t>(arity(node.op)); ++k) any = any || asks[node.of[k]];
    asks.push_back(any);
  }
  return asks;
}

bool asks_place(const std::vector<ProgramRound>& rounds) {
  const auto any = [](const RealGraph& graph) {
    return graph.reads(RealSource::position) || graph.reads(RealSource::noise);
  };
  return std::ranges::any_of(rounds, [&](auto& round) { return any(round.pair) || any(round.finish); });
}

}  // namespace

double reaches_of(const Rule& rule) {
  const RoundsRule* rounds = rule.rounds.get();
  if (rounds == nullptr) return 1;
  return static_cast<double>(rounds->text()->setup.size() + rounds->text()->rounds.size());
}

std::vector<std::string> starts_by_place(const Rule& rule) {
  std::vector<std::string> names;
  const RuleProgram& text = *rule.rounds->text();
  std::vector<bool> fields(text.particle_numbers, false);
  const auto asks = [&](const ProgramField& field, const RealGraph& graph) {
    const std::vector<bool> nodes = asking(graph, fields);
    const bool any = std::ranges::any_of(field.start, [&](NodeId at) { return nodes[at]; });
    if (any) names.push_back(field.name);
    return any;
  };
  for (const ProgramField& field : text.particle)
    if (asks(field, text.start)) std::fill_n(fields.begin() + field.first, field.numbers(), true);
  for (const ProgramField& field : text.bond) asks(field, text.bond_start);
  return names;
}

void refuse_cell(const Rule& rule) {
  const RoundsRule* rounds = rule.rounds.get();
  if (rounds == nullptr) return;
  const auto refuse = [](const std::string& what, const std::string& hint = "") {
    throw InputError(what, hint).about({"rule.file", "rule"});
  };
  if (rounds->text() == nullptr) refuse_rounds(rule, "what strains a cell");
  const RuleProgram& text = *rounds->text();
  if (const auto why = why_no_rest(*rounds))
    refuse("a cell at rest leaves out time, and " + why->what, why->hint);
  if (const auto names = starts_by_place(rule); !names.empty())
    refuse(fmt::format("the start of '{}' asks where it is, and a cell of the matter is anywhere", names[0]));
  if (asks_place(text.setup) || asks_place(text.rounds))
    refuse("the rule asks where a particle is, and a cell of the matter is anywhere");
}

}  // namespace cuboct
