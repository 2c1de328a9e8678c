// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/rounds_code.h"

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
         source != Source::bond_field && source != Source::bond_constant;
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
      if (node.source == Source::bond_field) number = program.bond_place(node.index) + node.axis;
      if (node.source == Source::sum) number = round.place(node.index) + node.axis;
      made.push_back({static_cast<uint8_t>(node.source), at(n), static_cast<uint8_t>(number),
                      static_cast<uint8_t>(node.axis)});
    }
    return made;
  }
  std::vector<Store> axes(const std::vector<int>& list) const {
    std::vector<Store> made;
    for (size_t a = 0; a < list.size(); ++a) made.push_back({at(list[a]), static_cast<uint8_t>(a)});
    return made;
  }
};

// Numbers of particles, or of bonds, that rounds have written.
class Written {
 public:
  explicit Written(int numbers) : written_(index(numbers)) {}
  Store once(uint8_t from, int number, const std::string& name) {
    if (written_[index(number)])
      throw InputError(fmt::format("two rounds make '{}': the gpu engine has it made once a step", name),
                       "engine lattice runs it")
          .about({"rule.file", "rule"});
    written_[index(number)] = true;
    return {from, static_cast<uint8_t>(number)};
  }

 private:
  std::vector<bool> written_;
};

void add_broken(const graph::FixedProgram& program, const graph::Round& round, RoundLists& lists) {
  if (program.broken_at < 0) return;
  const std::vector<int> nodes = needed_by(program.broken, {program.broken_at});
  const graph::Registers registers = registers_for(program.broken, {nodes}, {program.broken_at});
  if (registers.count > kMostRegisters)
    refuse(round.name, "values of a broken bond", index(registers.count), kMostRegisters);
  const Code code{program, round, program.broken, registers};
  lists.broken_constants = code.constants(nodes);
  lists.broken_code = code.operations(nodes, false);
  lists.broken_fetch = code.fetches(nodes, false);
  lists.broken = code.at(program.broken_at);
  lists.broken_registers = registers.count;
}

RoundLists code_of_round(const graph::FixedProgram& program, const graph::Round& round, Written& written,
                         Written& bonds_written) {
  const bool last = &round == &program.rounds.back();
  const graph::Motion motion = last ? program.motion : graph::Motion{};
  const std::vector<int> terms = terms_of(round), made = pair_outputs(round),
                         outputs = finish_outputs(program, round);
  const std::vector<int> early = needed_by(round.pair, {round.when});
  const std::vector<int> late = without(needed_by(round.pair, made), early);
  const std::vector<int> finish = needed_by(round.finish, outputs);
  std::vector<int> kept = made;
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
                   .when = pair.at(round.when),
                   .registers = static_cast<int>(registers),
                   .bond_writes = {},
                   .broken_constants = {},
                   .broken_code = {},
                   .broken_fetch = {}};
  for (const graph::Write& write : round.writes)
    lists.writes.push_back(written.once(done.at(write.node), program.place(write.field) + write.component,
                                        program.fields[index(write.field)].name));
  for (const graph::Write& write : round.bond_writes)
    lists.bond_writes.push_back(bonds_written.once(pair.at(write.node),
                                                   program.bond_place(write.field) + write.component,
                                                   program.bonds[index(write.field)].name));
  add_broken(program, round, lists);
  return lists;
}

}  // namespace

std::vector<RoundLists> code_of(const graph::FixedProgram& program) {
  if (program.numbers() > kMostNumbers)
    refuse(program.name, "numbers of a particle", index(program.numbers()), kMostNumbers);
  if (program.bond_numbers() > kMostBondNumbers)
    refuse(program.name, "numbers of a bond", index(program.bond_numbers()), kMostBondNumbers);
  Written written(program.numbers()), bonds_written(program.bond_numbers());
  std::vector<RoundLists> rounds;
  for (const graph::Round& round : program.rounds)
    rounds.push_back(code_of_round(program, round, written, bonds_written));
  return rounds;
}

}  // namespace cuboct::gpu
