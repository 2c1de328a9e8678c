// SPDX-License-Identifier: MIT
#include "cli/run/rule_integers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "hw/plan/setup.h"
#include "model/base/error_parts.h"
#include "model/graph/parity.h"
#include "model/program/integer_program.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

int products_in(const graph::Graph& graph) {
  return static_cast<int>(std::ranges::count_if(graph.nodes, [](const graph::Node& node) {
    return node.op == graph::Op::mul || node.op == graph::Op::mac || node.op == graph::Op::dot;
  }));
}

// Sums whose terms are odd add up to nothing over all particles.
std::string kept_by(const graph::Round& round) {
  const std::vector<graph::Parity> parities = graph::parities_of(round.pair);
  std::vector<std::string> odd, other;
  for (const graph::Sum& sum : round.sums) {
    const bool all = std::ranges::all_of(
        sum.terms, [&](int term) { return graph::is_odd(parities[static_cast<size_t>(term)]); });
    (all ? odd : other).push_back(sum.name);
  }
  std::string text;
  if (!odd.empty()) text = fmt::format("{} odd: kept to the last bit", fmt::join(odd, ", "));
  if (!other.empty()) text += fmt::format("{}{} not odd", text.empty() ? "" : "; ", fmt::join(other, ", "));
  return text;
}

void add_round(Items& items, const graph::Round& round, const std::vector<Integers::Fit>& tables) {
  std::string text = fmt::format("{} operations a pair, {} of them products; {} a particle",
                                 round.pair.nodes.size(), products_in(round.pair), round.finish.nodes.size());
  double worst = 0;
  for (const Integers::Fit& fit : tables) worst = std::max(worst, fit.error);
  if (!tables.empty())
    text += fmt::format("; {} table{}, off by {:.1e} of its largest value at most", tables.size(),
                        tables.size() == 1 ? "" : "s", worst);
  items.add("integers of " + round.name, text, kept_by(round));
}

void add_bonds(Items& items, const IntegerProgram& program) {
  if (!program.rows) return;
  for (const graph::Field& field : program.program.bonds)
    items.add("format of " + field.name,
              field.range == graph::Interval{0, 1} ? "a bit" : fmt::format("units of 2^{}", -field.frac),
              "of a bond; both ends write the same");
  items.add("bonds",
            fmt::format("{}, at most {} of a particle, of {} length{}", program.rows->other.size() / 2,
                        program.rows->longest(), program.lengths, program.lengths == 1 ? "" : "s"),
            program.program.broken_at < 0 ? "all must be met in the 27 cells"
                                          : "broken for ever: those may be anywhere");
}

// What a node of the rule's machine holds, sends and waits for.
void add_machine(Items& items, const Plan& plan) {
  if (const std::string why = machine_refusal(plan); !why.empty()) {
    items.add("machine", "none: " + why);
    return;
  }
  items.add("machine",
            fmt::format("{} node{} of {} slots of {} bits", plan.nodes(), plan.nodes() == 1 ? "" : "s",
                        plan.arch.capacity, plan.words.particle_bits));
  for (size_t k = 0; k < plan.rounds.size(); ++k) {
    const PlanRound& round = plan.rounds[k];
    const std::string record = round.beats == 0
                                   ? std::string("nothing is sent")
                                   : fmt::format("a record of {} bits in {} beat{}", bits_of(round.record),
                                                 round.beats, round.beats == 1 ? "" : "s");
    items.add("machine of " + plan.program->program.rounds[k].name,
              fmt::format("{}; {} cycles from a pair to its sum, {} of a finish", record, round.pipe,
                          round.finish));
  }
}

}  // namespace

void add_integers(Items& items, const Scene& scene, const Arch& arch) {
  const RoundsRule* rounds = scene.rule.rounds.get();
  if (rounds == nullptr || rounds->text() == nullptr) return;
  try {
    const Plan plan = program_plan_of(scene, arch);
    const IntegerProgram& program = *plan.program;
    for (const graph::Field& field : program.program.fields)
      items.add("format of " + field.name, fmt::format("units of 2^{}", -field.frac),
                "integers of engine golden");
    add_bonds(items, program);
    for (size_t k = 0; k < program.program.rounds.size(); ++k)
      add_round(items, program.program.rounds[k], program.tables[k]);
    add_machine(items, plan);
  } catch (const InputError& error) {
    items.add("integers", "none: " + parts_of(error).message);
  }
}

}  // namespace cuboct
