// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/rounds_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

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

// What is rounded as soon as it is made, or read, is so at once: what a product was before needs no more than
// 64 bits.
graph::Graph with_joined_roundings(graph::Graph graph) {
  for (Node& node : graph.nodes) {
    if (node.op != Op::round) continue;
    const Node of = node_of(graph, node.inputs[0]);
    const bool product = of.op == Op::mul || of.op == Op::dot;
    if ((!product && of.op != Op::input) || of.shift != 0) continue;
    node.op = of.op, node.inputs = of.inputs;
    node.source = of.source, node.index = of.index, node.axis = of.axis;
  }
  return graph;
}

// Those of `list` that depend on a particle alone.
std::vector<int> of_particle(const graph::Graph& graph, const std::vector<int>& list) {
  std::vector<bool> alone(graph.nodes.size());
  std::vector<int> found;
  for (const int n : list) {
    const Node& node = node_of(graph, n);
    if (node.op == Op::constant || node.op == Op::input)
      alone[index(n)] = node.op == Op::constant || is_own(node.source);
    else
      alone[index(n)] = node.op != Op::within && node.op != Op::check &&
                        std::ranges::all_of(node.inputs, [&](int k) { return alone[index(k)]; });
    if (alone[index(n)]) found.push_back(n);
  }
  return found;
}

bool is_narrow(graph::Interval range) {
  return range.low >= std::numeric_limits<int32_t>::min() &&
         range.high <= std::numeric_limits<int32_t>::max();
}

// A rounding adds half, and takes 1 from what is negative.
bool rounds_narrow(graph::Interval of, int shift) {
  return shift > 0 && shift < 32 && is_narrow({of.low - 1, of.high + (int64_t{1} << (shift - 1))});
}

// `list` in another order: after a node come those that are like it and can be computed, as axes of a vector.
template <class Alike>
std::vector<int> grouped(const graph::Graph& graph, const std::vector<int>& list, const Alike& alike) {
  std::vector<int> rest = list, order;
  std::vector<bool> waits(graph.nodes.size());
  for (const int n : list) waits[index(n)] = true;
  const auto ready = [&](int n) {
    return std::ranges::none_of(node_of(graph, n).inputs, [&](int k) { return waits[index(k)]; });
  };
  while (!rest.empty()) {
    auto next = rest.end();
    if (!order.empty())
      next = std::ranges::find_if(rest, [&](int n) { return alike(order.back(), n) && ready(n); });
    if (next == rest.end()) next = rest.begin();  // its inputs stand before it
    waits[index(*next)] = false;
    order.push_back(*next);
    rest.erase(next);
  }
  return order;
}

// A graph with the registers of its values, and its code.
class Code {
 public:
  // `parts`, `outputs`: as of graph::registers_for.
  Code(const graph::FixedProgram& program, const graph::Round& round, const graph::Graph& nodes,
       const std::vector<std::vector<int>>& parts, const std::vector<int>& outputs)
      : program_(program), round_(round), nodes_(nodes), sizes_(nodes.nodes.size(), 1) {
    for (size_t part = 0; part < parts.size(); ++part)
      for (const int n : parts[part]) {
        const Node& node = node_of(nodes, n);
        bool narrow = is_narrow(node.range);
        if (part > 0 && node.op == Op::within) narrow = narrow || !is_wide(node.inputs[0]);
        sizes_[index(n)] = node.op == Op::constant ? 0 : narrow ? 1 : 2;
      }
    registers_ = registers_for(nodes, parts, outputs, sizes_);
  }

  uint8_t at(int n) { return is_constant(n) ? constant(node_of(nodes_, n).number).to : register_of(n); }
  bool is_wide(int n) const {
    return is_constant(n) ? !is_narrow(node_of(nodes_, n).range) : sizes_[index(n)] == 2;
  }
  bool is_constant(int n) const { return node_of(nodes_, n).op == Op::constant; }

  std::vector<Operation> operations(const std::vector<int>& list, bool all_count) {
    std::vector<Operation> made;
    for (const int n : list)
      if (const Node& node = node_of(nodes_, n); is_computed(node) && !(all_count && node.op == Op::within))
        made.push_back(operation(n));
    for (size_t k = 0; k + 1 < made.size(); ++k)
      if (made[k].op() == made[k + 1].op() && made[k].inputs() == made[k + 1].inputs() &&
          made[k].narrow() == made[k + 1].narrow())
        made[k].word[0] |= Operation::kMore;
    return made;
  }
  // Of those of own, or of a pair.
  std::vector<Fetch> fetches(const std::vector<int>& list, bool own) {
    std::vector<Fetch> made;
    for (const int n : list) {
      const Node& node = node_of(nodes_, n);
      if (node.op != Op::input || is_own(node.source) != own) continue;
      int number = node.index;
      if (node.source == Source::own_field || node.source == Source::other_field)
        number = program_.place(node.index) + node.axis;
      if (node.source == Source::bond_field) number = program_.bond_place(node.index) + node.axis;
      if (node.source == Source::sum) number = round_.place(node.index) + node.axis;
      made.push_back({static_cast<uint8_t>(node.source), at(n), is_wide(n), static_cast<uint8_t>(number),
                      static_cast<uint8_t>(node.axis), static_cast<uint8_t>(node.shift),
                      is_narrow_apart(node)});
    }
    return made;
  }
  Store store(int n, int to) { return {at(n), is_wide(n), static_cast<uint8_t>(to)}; }
  std::vector<Store> axes(const std::vector<int>& list) {
    std::vector<Store> made;
    for (size_t a = 0; a < list.size(); ++a) made.push_back(store(list[a], static_cast<int>(a)));
    return made;
  }
  // That `at`, `operations` and the others have met.
  const std::vector<Constant>& constants() const { return constants_; }
  // With those of constants.
  int registers() const { return registers_.count; }

 private:
  bool is_narrow_apart(const Node& node) const {
    const graph::Interval range = range_of_apart();
    return node.source == Source::apart &&
           (node.shift == 0 ? is_narrow(range) : rounds_narrow(range, node.shift));
  }
  // Two cells, of which each position lies in one.
  graph::Interval range_of_apart() const {
    const int64_t most = (int64_t{1} << (program_.position_frac + 1)) - 1;
    return {-most, most};
  }
  uint8_t register_of(int n) const { return static_cast<uint8_t>(registers_.of[index(n)]); }
  const Constant& constant(int64_t value) {
    const auto known = std::find_if(constants_.begin(), constants_.end(),
                                    [&](const Constant& c) { return c.value == value; });
    if (known != constants_.end()) return *known;
    const bool wide = !is_narrow({value, value});
    constants_.push_back({value, static_cast<uint8_t>(registers_.count), wide});
    registers_.count += wide ? 2 : 1;
    return constants_.back();
  }

  struct Inputs {
    std::vector<uint8_t> at;
    uint32_t wide = 0;  // bits
    void add(uint8_t place, bool is_wide) {
      wide |= static_cast<uint32_t>(is_wide) << at.size();
      at.push_back(place);
    }
  };
  Inputs inputs_of(const Node& node) {
    Inputs inputs;
    for (const int n : node.inputs) inputs.add(at(n), is_wide(n));
    std::vector<int64_t> more;
    if (node.op == Op::clamp || node.op == Op::within) more = {node.range.low, node.range.high};
    if (node.op == Op::noise) more = {node.number};
    for (const int64_t value : more) {
      const Constant& input = constant(value);
      inputs.add(input.to, input.wide);
    }
    if (inputs.at.size() > kMostInputs)
      refuse(round_.name, "inputs of one operation", inputs.at.size(), kMostInputs);
    return inputs;
  }

  Operation operation(int n) {
    const Node& node = node_of(nodes_, n);
    const Inputs inputs = inputs_of(node);
    Operation made{};
    made.set(0, static_cast<int>(node.op));
    if (is_wide(n)) made.word[0] |= Operation::kWideOut;
    if (is_narrow_operation(n, inputs.wide)) made.word[0] |= Operation::kNarrow;
    made.set(2, static_cast<int>(inputs.wide));
    made.set(3, register_of(n));
    for (size_t k = 0; k < inputs.at.size(); ++k) made.set(4 + static_cast<int>(k), inputs.at[k]);
    made.set(10, static_cast<int>(inputs.at.size()));
    made.set(11, node.shift);
    made.set(12, node.width);
    made.set(13, std::max(node.table, 0));
    return made;
  }
  bool is_narrow_operation(int n, uint32_t wide_inputs) const {
    const Node& node = node_of(nodes_, n);
    if (node.op == Op::mul || node.op == Op::dot) return wide_inputs == 0;
    if (wide_inputs != 0 || is_wide(n)) return false;
    return node.op != Op::round || rounds_narrow(node_of(nodes_, node.inputs[0]).range, node.shift);
  }

  const graph::FixedProgram& program_;
  const graph::Round& round_;
  const graph::Graph& nodes_;
  std::vector<int> sizes_;  // 0: of constants, which have theirs behind the others'
  graph::Registers registers_;
  std::vector<Constant> constants_;
};

// Numbers of particles, or of bonds, that rounds have written.
class Written {
 public:
  explicit Written(int numbers) : written_(index(numbers)) {}
  void once(int number, const std::string& name) {
    if (written_[index(number)])
      throw InputError(fmt::format("two rounds make '{}': the gpu engine has it made once a step", name),
                       "engine lattice runs it")
          .about({"rule.file", "rule"});
    written_[index(number)] = true;
  }

 private:
  std::vector<bool> written_;
};

void add_broken(const graph::FixedProgram& program, const graph::Round& round, RoundLists& lists) {
  if (program.broken_at < 0) return;
  const std::vector<int> nodes = needed_by(program.broken, {program.broken_at});
  Code code(program, round, program.broken, {nodes}, {program.broken_at});
  lists.broken_code = code.operations(nodes, false);
  lists.broken_fetch = code.fetches(nodes, false);
  lists.broken = code.at(program.broken_at);
  lists.broken_constants = code.constants();
  lists.broken_registers = code.registers();
  if (lists.broken_registers > kMostRegisters)
    refuse(round.name, "registers of a broken bond", index(lists.broken_registers), kMostRegisters);
}

void add_pair(const graph::FixedProgram& program, const graph::Round& round, RoundLists& lists) {
  const graph::Graph graph = with_joined_roundings(round.pair);
  const auto alike = [&](int a, int b) { return node_of(graph, a).op == node_of(graph, b).op; };
  std::vector<int> kept = pair_outputs(round);
  const std::vector<int> all = needed_by(graph, kept);
  kept.push_back(round.when);
  const std::vector<int> prepare = of_particle(graph, needed_by(graph, kept));
  const std::vector<int> when = needed_by(graph, {round.when});
  const std::vector<int> early = grouped(graph, without(when, prepare), alike);
  const std::vector<int> late = grouped(graph, without(without(all, when), prepare), alike);
  // What is made once serves all partners.
  for (const std::vector<int>* list : {&early, &late})
    for (const int n : *list)
      for (const int input : node_of(graph, n).inputs)
        if (std::ranges::binary_search(prepare, input)) kept.push_back(input);
  std::vector<int> first = prepare;
  first.insert(first.end(), early.begin(), early.end());

  Code code(program, round, graph, {first, late}, kept);
  lists.prepare = code.operations(prepare, false);
  lists.early = code.operations(early, false);
  lists.late = code.operations(late, true);
  lists.own = code.fetches(prepare, true);
  lists.early_fetch = code.fetches(early, false);
  lists.late_fetch = code.fetches(late, false);
  if (const Node& counts = node_of(graph, round.when); counts.op != Op::constant || counts.number == 0)
    lists.when = code.at(round.when);
  for (Fetch& apart : lists.apart) apart.to = kNowhere;
  // Registers of the late ones may still be in use.
  std::erase_if(lists.when < 0 ? lists.late_fetch : lists.early_fetch, [&](const Fetch& fetch) {
    Fetch& apart = lists.apart[fetch.axis];
    if (static_cast<Source>(fetch.source) != Source::apart || apart.to != kNowhere) return false;
    apart = fetch;
    return true;
  });
  lists.terms = code.axes(terms_of(round));
  for (const graph::Write& write : round.bond_writes)
    lists.bond_writes.push_back(code.store(write.node, program.bond_place(write.field) + write.component));
  lists.constants = code.constants();
  lists.registers = code.registers();
}

void add_finish(const graph::FixedProgram& program, const graph::Round& round, RoundLists& lists) {
  const bool last = &round == &program.rounds.back();
  const graph::Motion motion = last ? program.motion : graph::Motion{};
  const graph::Graph graph = with_joined_roundings(round.finish);
  const std::vector<int> outputs = finish_outputs(program, round);
  const std::vector<int> finish = needed_by(graph, outputs);

  Code code(program, round, graph, {finish}, outputs);
  lists.finish = code.operations(finish, false);
  lists.finish_fetch = code.fetches(finish, true);
  for (const graph::Write& write : round.writes)
    lists.writes.push_back(code.store(write.node, program.place(write.field) + write.component));
  lists.v = code.axes(motion.v);
  lists.u = code.axes(motion.u);
  lists.drift = code.axes(motion.drift);
  lists.finish_constants = code.constants();
  lists.registers = std::max(lists.registers, code.registers());
}

RoundLists code_of_round(const graph::FixedProgram& program, const graph::Round& round, Written& written,
                         Written& bonds_written) {
  for (const graph::Write& write : round.writes)
    written.once(program.place(write.field) + write.component, program.fields[index(write.field)].name);
  for (const graph::Write& write : round.bond_writes)
    bonds_written.once(program.bond_place(write.field) + write.component,
                       program.bonds[index(write.field)].name);
  const size_t terms = terms_of(round).size();
  if (terms > kMostNumbers) refuse(round.name, "numbers of sums", terms, kMostNumbers);
  RoundLists lists;
  add_pair(program, round, lists);
  add_finish(program, round, lists);
  if (lists.registers > kMostRegisters)
    refuse(round.name, "registers", index(lists.registers), kMostRegisters);
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
