// SPDX-License-Identifier: MIT
#include "gpu_ref/rounds_code.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/error.h"
#include "model/graph/registers.h"

namespace cuboct::gpu {
namespace {

using graph::Node;
using graph::Op;
using graph::Source;

size_t index(int n) { return static_cast<size_t>(n); }
const Node& node_of(const graph::Graph& graph, int n) { return graph.nodes[index(n)]; }

[[noreturn]] void refuse(const std::string& round, const std::string& what, size_t has, size_t most) {
  throw InputError(
      fmt::format("round '{}' has {} {}: a thread of the gpu engine has room for {}", round, has, what, most),
      "engine lattice runs it")
      .about({"rule.file", "rule"});
}

bool is_own(Source source) {
  return source != Source::apart && source != Source::other_v && source != Source::other_constant &&
         source != Source::pair_constant && source != Source::other_field && source != Source::other_id &&
         source != Source::bond_field;
}

// Nodes that a list needs beside those of another.
std::vector<int> without(const std::vector<int>& nodes, const std::vector<int>& others) {
  std::vector<int> rest;
  std::set_difference(nodes.begin(), nodes.end(), others.begin(), others.end(), std::back_inserter(rest));
  return rest;
}

// The code of a list of nodes.
struct Code {
  const graph::FixedProgram& program;
  const graph::Round& round;
  const graph::Graph& nodes;
  const graph::Registers& registers;

  uint8_t at(int n) const { return static_cast<uint8_t>(registers.of[index(n)]); }

  Operation operation(int n) const {
    const Node& node = node_of(nodes, n);
    Operation made{};
    made.op = static_cast<uint8_t>(node.op);
    made.low = node.range.low, made.high = node.range.high;
    if (node.op == Op::noise) made.low = node.number;
    made.shift = static_cast<uint8_t>(node.shift), made.width = static_cast<uint8_t>(node.width);
    made.out = at(n);
    made.table = static_cast<uint8_t>(std::max(node.table, 0));
    made.inputs = static_cast<uint8_t>(node.inputs.size());
    if (node.inputs.size() > kMostInputs)
      refuse(round.name, "inputs of one operation", node.inputs.size(), kMostInputs);
    for (size_t k = 0; k < node.inputs.size(); ++k) made.in[k] = at(node.inputs[k]);
    return made;
  }
  std::vector<Operation> operations(const std::vector<int>& list, bool all_count) const {
    std::vector<Operation> made;
    for (const int n : list)
      if (const Node& node = node_of(nodes, n); is_computed(node) && !(all_count && node.op == Op::within))
        made.push_back(operation(n));
    return made;
  }
  std::vector<Operation> constants(const std::vector<int>& list) const {
    std::vector<Operation> made;
    for (const int n : list)
      if (node_of(nodes, n).op == Op::constant) made.push_back(operation(n));
    return made;
  }
  // Of those of own, or of a pair.
  std::vector<Fetch> fetches(const std::vector<int>& list, bool own) const {
    std::vector<Fetch> made;
    for (const int n : list) {
      const Node& node = node_of(nodes, n);
      if (node.op != Op::input || is_own(node.source) != own) continue;
      int number = node.index;
      if (node.source == Source::own_field || node.source == Source::other_field)
        number = program.place(node.index) + node.axis;
      if (node.source == Source::sum) number = first_of_sum(node.index) + node.axis;
      if (node.source == Source::bond_field)
        throw InputError("the gpu engine holds no bonds of a rule of text", "engine golden runs it")
            .about({"rule.file", "rule"});
      made.push_back({static_cast<uint8_t>(node.source), at(n), static_cast<uint8_t>(number),
                      static_cast<uint8_t>(node.axis)});
    }
    return made;
  }
  int first_of_sum(int sum) const {
    size_t first = 0;
    for (int k = 0; k < sum; ++k) first += round.sums[index(k)].terms.size();
    return static_cast<int>(first);
  }
  std::vector<Store> axes(const std::vector<int>& list) const {
    std::vector<Store> made;
    for (size_t a = 0; a < list.size(); ++a) made.push_back({at(list[a]), static_cast<uint8_t>(a)});
    return made;
  }
};

RoundLists code_of_round(const graph::FixedProgram& program, const graph::Round& round,
                         std::vector<bool>& written) {
  std::vector<int> terms;
  for (const graph::Sum& sum : round.sums) terms.insert(terms.end(), sum.terms.begin(), sum.terms.end());
  std::vector<int> outputs;
  for (const graph::Write& write : round.writes) outputs.push_back(write.node);
  const bool last = &round == &program.rounds.back();
  const graph::Motion motion = last ? program.motion : graph::Motion{};
  for (const auto* nodes : {&motion.v, &motion.u, &motion.drift})
    outputs.insert(outputs.end(), nodes->begin(), nodes->end());

  const std::vector<int> early = needed_by(round.pair, {round.when});
  const std::vector<int> late = without(needed_by(round.pair, terms), early);
  const std::vector<int> finish = needed_by(round.finish, outputs);
  std::vector<int> kept = terms;
  kept.push_back(round.when);
  const graph::Registers pair_registers = registers_for(round.pair, {early, late}, kept);
  const graph::Registers finish_registers = registers_for(round.finish, {finish}, outputs);
  const auto registers = static_cast<size_t>(std::max(pair_registers.count, finish_registers.count));
  if (registers > kMostRegisters) refuse(round.name, "values at a time", registers, kMostRegisters);
  if (terms.size() > kMostNumbers) refuse(round.name, "numbers of sums", terms.size(), kMostNumbers);

  const Code pair{program, round, round.pair, pair_registers};
  const Code done{program, round, round.finish, finish_registers};
  std::vector<int> both = early;
  both.insert(both.end(), late.begin(), late.end());
  RoundLists lists{.constants = pair.constants(both),
                   .early = pair.operations(early, false),
                   .late = pair.operations(late, true),
                   .finish_constants = done.constants(finish),
                   .finish = done.operations(finish, false),
                   .own = pair.fetches(both, true),
                   .early_fetch = pair.fetches(early, false),
                   .late_fetch = pair.fetches(late, false),
                   .finish_fetch = done.fetches(finish, true),
                   .terms = pair.axes(terms),
                   .writes = {},
                   .v = done.axes(motion.v),
                   .u = done.axes(motion.u),
                   .drift = done.axes(motion.drift),
                   .when = pair.at(round.when)};
  for (const graph::Write& write : round.writes) {
    const int number = program.place(write.field) + write.component;
    lists.writes.push_back({done.at(write.node), static_cast<uint8_t>(number)});
    if (written[index(number)])
      throw InputError(fmt::format("two rounds make '{}': the gpu engine has it made once a step",
                                   program.fields[index(write.field)].name),
                       "engine lattice runs it")
          .about({"rule.file", "rule"});
    written[index(number)] = true;
  }
  return lists;
}

}  // namespace

std::vector<RoundLists> code_of(const graph::FixedProgram& program) {
  if (program.numbers() > kMostNumbers)
    refuse(program.name, "numbers of a particle", index(program.numbers()), kMostNumbers);
  std::vector<bool> written(index(program.numbers()));
  std::vector<RoundLists> rounds;
  for (const graph::Round& round : program.rounds) rounds.push_back(code_of_round(program, round, written));
  return rounds;
}

}  // namespace cuboct::gpu
