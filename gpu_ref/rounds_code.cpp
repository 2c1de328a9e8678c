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
  std::ranges::set_difference(nodes, others, std::back_inserter(rest));
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

}  // namespace

template <typename T>
Span<T> ProgramOnDevice::put(Stream& stream, const std::vector<T>& values, std::vector<Array<T>>& into) {
  Array<T>& array = into.emplace_back(stream.device());
  array.set(stream, values);
  return {array.data(), static_cast<int>(values.size())};
}

const CodeTable* ProgramOnDevice::put_tables(Stream& stream, const graph::Graph& graph) {
  std::vector<CodeTable> tables;
  for (const FixedTable& table : graph.tables)
    tables.push_back({static_cast<int>(table.shape), table.degree, table.difference_frac, table.index_bits,
                      table.bin_bits, table.first_octave, table.fraction_bits,
                      put(stream, table.c0, entries_).data, put(stream, table.c1, entries_).data,
                      put(stream, table.c2, entries_).data});
  return put(stream, tables, tables_).data;
}

RoundCode ProgramOnDevice::code_of(Stream& stream, const graph::FixedProgram& program,
                                   const graph::Round& round) {
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
  RoundCode code{};
  code.constants = put(stream, pair.constants(both), operations_);
  code.early = put(stream, pair.operations(early, false), operations_);
  code.late = put(stream, pair.operations(late, true), operations_);
  code.finish_constants = put(stream, done.constants(finish), operations_);
  code.finish = put(stream, done.operations(finish, false), operations_);
  code.own = put(stream, pair.fetches(both, true), fetches_);
  code.early_fetch = put(stream, pair.fetches(early, false), fetches_);
  code.late_fetch = put(stream, pair.fetches(late, false), fetches_);
  code.finish_fetch = put(stream, done.fetches(finish, true), fetches_);
  code.terms = put(stream, pair.axes(terms), stores_);
  std::vector<Store> writes;
  for (const graph::Write& write : round.writes) {
    const int number = program.place(write.field) + write.component;
    writes.push_back({done.at(write.node), static_cast<uint8_t>(number)});
    if (written_[index(number)])
      throw InputError(fmt::format("two rounds make '{}': the gpu engine has it made once a step",
                                   program.fields[index(write.field)].name),
                       "engine lattice runs it")
          .about({"rule.file", "rule"});
    written_[index(number)] = true;
  }
  code.writes = put(stream, writes, stores_);
  code.v = put(stream, done.axes(motion.v), stores_);
  code.u = put(stream, done.axes(motion.u), stores_);
  code.drift = put(stream, done.axes(motion.drift), stores_);
  code.tables = put_tables(stream, round.pair);
  code.finish_tables = put_tables(stream, round.finish);
  code.type_constants = type_constants_, code.pair_constants = pair_constants_;
  code.types = program.types;
  code.when = pair.at(round.when);
  code.sums = static_cast<int>(terms.size());
  return code;
}

ProgramOnDevice::ProgramOnDevice(Stream& stream, const graph::FixedProgram& program)
    : written_(index(program.numbers())) {
  if (program.numbers() > kMostNumbers)
    refuse(program.name, "numbers of a particle", index(program.numbers()), kMostNumbers);
  const auto values_of = [&](const std::vector<graph::Constants>& constants) {
    std::vector<int64_t> values;
    for (const graph::Constants& one : constants)
      values.insert(values.end(), one.values.begin(), one.values.end());
    return put(stream, values, constants_).data;
  };
  type_constants_ = values_of(program.type_constants);
  pair_constants_ = values_of(program.pair_constants);
  for (const graph::Round& round : program.rounds) rounds_.push_back(code_of(stream, program, round));
}

}  // namespace cuboct::gpu
