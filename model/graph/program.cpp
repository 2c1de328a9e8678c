// SPDX-License-Identifier: MIT
#include "model/graph/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "model/graph/parity.h"

namespace cuboct::graph {
namespace {

bool inside(Interval a, Interval b) { return b.holds(a.low) && b.holds(a.high); }

Interval range_in(const Graph& graph, int node, const std::string& what) {
  if (node < 0 || node >= static_cast<int>(graph.nodes.size()))
    throw std::logic_error(fmt::format("{}: no such node", what));
  return graph.nodes[static_cast<size_t>(node)].range;
}

void check_fits(const Graph& graph, int node, Interval room, const std::string& what) {
  const Interval range = range_in(graph, node, what);
  if (!inside(range, room))
    throw std::logic_error(fmt::format("{} lies in [{}, {}], beyond [{}, {}]", what, range.low, range.high,
                                       room.low, room.high));
}

void check_writes(const std::vector<Field>& fields, const Graph& graph, const std::vector<Write>& writes) {
  for (const Write& write : writes) {
    const Field& field = fields.at(static_cast<size_t>(write.field));
    if (write.component < 0 || write.component >= field.numbers)
      throw std::logic_error(fmt::format("field {} has no component {}", field.name, write.component));
    check_fits(graph, write.node, field.range, "field " + field.name);
  }
}

void check_pair(const FixedProgram& program, const Round& round) {
  check_fits(round.pair, round.when, {0, 1}, "when");
  for (const int n : needed_by(round.pair, {round.when}))
    if (round.pair.nodes[static_cast<size_t>(n)].op == Op::check)
      throw std::logic_error(fmt::format("when needs the check {}", label(round.pair, n)));
  for (const Sum& sum : round.sums)
    for (const int term : sum.terms) range_in(round.pair, term, "sum " + sum.name);
  if (!program.bonded && !round.bond_writes.empty())
    throw std::logic_error("a program without bonds writes some");
  check_writes(program.bonds, round.pair, round.bond_writes);
  const std::vector<Parity> parity = parities_of(round.pair);
  for (const Write& write : round.bond_writes)
    if (!is_even(parity[static_cast<size_t>(write.node)]))
      throw std::logic_error(fmt::format("the ends of a bond write {} differently",
                                         program.bonds[static_cast<size_t>(write.field)].name));
}

void check_broken(const FixedProgram& program) {
  if (program.broken_at < 0) return;
  check_fits(program.broken, program.broken_at, {0, 1}, "broken");
  for (const Node& node : program.broken.nodes)
    if (node.op == Op::input && node.source != Source::bond_field && node.source != Source::bond_constant)
      throw std::logic_error(fmt::format("broken reads {}", to_string(node.source)));
}

int place_in(const std::vector<Field>& fields, int field) {
  int place = 0;
  for (int k = 0; k < field; ++k) place += fields[static_cast<size_t>(k)].numbers;
  return place;
}

void check_motion(const FixedProgram& program, const Graph& finish) {
  const auto axes = static_cast<size_t>(program.axes);
  const Motion& motion = program.motion;
  if (motion.v.size() != axes || motion.drift.size() != axes ||
      (!motion.u.empty() && motion.u.size() != axes))
    throw std::logic_error("the motion has one node for each axis");
  const int64_t cell = int64_t{1} << (program.position_frac + program.guard);
  for (const int node : motion.v) check_fits(finish, node, program.velocity, "the velocity");
  for (const int node : motion.u) check_fits(finish, node, program.displacement, "the displacement");
  for (const int node : motion.drift) check_fits(finish, node, {-cell, cell}, "the drift");
}

}  // namespace

int Round::numbers() const { return place(static_cast<int>(sums.size())); }

int Round::place(int sum) const {
  size_t first = 0;
  for (int k = 0; k < sum; ++k) first += sums[static_cast<size_t>(k)].terms.size();
  return static_cast<int>(first);
}

std::vector<int64_t> beginning_of(const std::vector<Field>& fields) {
  std::vector<int64_t> numbers;
  for (const Field& field : fields)
    numbers.insert(numbers.end(), static_cast<size_t>(field.numbers),
                   std::clamp<int64_t>(0, field.range.low, field.range.high));
  return numbers;
}

std::vector<int> terms_of(const Round& round) {
  std::vector<int> terms;
  for (const Sum& sum : round.sums) terms.insert(terms.end(), sum.terms.begin(), sum.terms.end());
  return terms;
}

std::vector<int> pair_outputs(const Round& round) {
  std::vector<int> nodes = terms_of(round);
  for (const Write& write : round.bond_writes) nodes.push_back(write.node);
  return nodes;
}

std::vector<int> finish_outputs(const FixedProgram& program, const Round& round) {
  std::vector<int> nodes;
  for (const Write& write : round.writes) nodes.push_back(write.node);
  if (&round == &program.rounds.back())
    for (const auto* motion : {&program.motion.v, &program.motion.u, &program.motion.drift})
      nodes.insert(nodes.end(), motion->begin(), motion->end());
  return nodes;
}

bool reads_step(const FixedProgram& program) {
  const auto reads = [](const Graph& graph) {
    return std::ranges::any_of(
        graph.nodes, [](const Node& node) { return node.op == Op::input && node.source == Source::step; });
  };
  return std::ranges::any_of(program.rounds,
                             [&](const Round& round) { return reads(round.pair) || reads(round.finish); });
}

bool moves(const FixedProgram& program) {
  const std::vector<Node>& nodes = program.rounds.back().finish.nodes;
  return std::ranges::any_of(program.motion.drift, [&](int k) {
    const Node& node = nodes[static_cast<size_t>(k)];
    return node.op != Op::constant || node.number != 0;
  });
}

int FixedProgram::numbers() const { return place(static_cast<int>(fields.size())); }
int FixedProgram::place(int field) const { return place_in(fields, field); }
int FixedProgram::bond_numbers() const { return bond_place(static_cast<int>(bonds.size())); }
int FixedProgram::bond_place(int field) const { return place_in(bonds, field); }

bool FixedProgram::symmetric(int constant) const {
  const auto& values = pair_constants.at(static_cast<size_t>(constant)).values;
  const auto at = [&](int i, int j) { return values.at(static_cast<size_t>(i * types + j)); };
  for (int i = 0; i < types; ++i)
    for (int j = 0; j < i; ++j)
      if (at(i, j) != at(j, i)) return false;
  return true;
}

// Own X is in [0, 2^P), other's in [-2^P, 2^(P+1)).
int read_apart(Builder& b, const FixedProgram& program, int axis) {
  const int64_t most = (int64_t{2} << program.position_frac) - 1;
  return b.input(Source::apart, 0, axis, {-most, most}, program.position_frac);
}

int read_velocity(Builder& b, const FixedProgram& program, Source source, int axis) {
  return b.input(source, 0, axis, program.velocity, program.position_frac + program.guard);
}

int read_displacement(Builder& b, const FixedProgram& program, int axis) {
  return b.input(Source::own_u, 0, axis, program.displacement, program.position_frac + program.guard);
}

int read_constant(Builder& b, const FixedProgram& program, Source source, int constant) {
  const bool of_pair = source == Source::pair_constant;
  const auto& all = of_pair ? program.pair_constants : program.type_constants;
  const Constants& of = all.at(static_cast<size_t>(constant));
  const auto [low, high] = std::minmax_element(of.values.begin(), of.values.end());
  const int node =
      b.input(source, constant, 0, {*low, *high}, of.frac, of_pair && program.symmetric(constant));
  return *low == *high ? node : b.named(node, of.name);
}

int read_field(Builder& b, const FixedProgram& program, Source source, int field, int component) {
  const Field& of = program.fields.at(static_cast<size_t>(field));
  return b.input(source, field, component, of.range, of.frac);
}

int read_bond(Builder& b, const FixedProgram& program, int field, int component) {
  const Field& of = program.bonds.at(static_cast<size_t>(field));
  return b.input(Source::bond_field, field, component, of.range, of.frac);
}

int read_bond_constant(Builder& b, const FixedProgram& program, int constant) {
  const BondConstant& of = program.bond_constants.at(static_cast<size_t>(constant));
  const int node = b.input(Source::bond_constant, constant, 0, of.range, of.frac, of.parity == Parity::even,
                           of.parity == Parity::odd);
  return of.range.low == of.range.high ? node : b.named(node, of.name);
}

int read_sum(Builder& b, const FixedProgram& program, const Round& round, int sum, int component) {
  const Sum& of = round.sums.at(static_cast<size_t>(sum));
  const Node& term = round.pair.nodes.at(static_cast<size_t>(of.terms.at(static_cast<size_t>(component))));
  const int node = b.input(Source::sum, sum, component, summed(term.range, program.partners), term.frac);
  return b.named(node, of.name);
}

Interval summed(Interval term, int partners) {
  const Wide low = Wide{std::min<int64_t>(term.low, 0)} * partners;
  const Wide high = Wide{std::max<int64_t>(term.high, 0)} * partners;
  if (low < kWidest.low || high > kWidest.high)
    throw InputError(
        fmt::format("{} terms of [{}, {}] make a sum of more than 63 bits", partners, term.low, term.high));
  return {static_cast<int64_t>(low), static_cast<int64_t>(high)};
}

void check(const FixedProgram& program) {
  if (program.rounds.empty()) throw std::logic_error("a program without rounds");
  for (const Round& round : program.rounds) {
    check_pair(program, round);
    check_writes(program.fields, round.finish, round.writes);
  }
  check_broken(program);
  check_motion(program, program.rounds.back().finish);
}

}  // namespace cuboct::graph
