// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/rounds_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/graph/emit_integers.h"
#include "model/graph/interval.h"

namespace cuboct::gpu {
namespace {

using graph::FixedProgram;
using graph::Graph;
using graph::Node;
using graph::Op;
using graph::Source;

const Node& node_at(const Graph& graph, int n) { return graph.nodes[static_cast<size_t>(n)]; }

bool is_of_own(Source source) {
  return source == Source::own_x || source == Source::own_v || source == Source::own_u ||
         source == Source::own_constant || source == Source::own_field || source == Source::own_id ||
         source == Source::step;
}

// The entries of all tables of a program.
class Entries {
 public:
  // Where those of `table` begin.
  size_t add(const FixedTable& table) {
    for (const auto& [known, first] : tables_)
      if (*known == table) return first;
    const size_t first = entries.size();
    const std::vector<TableEntry> more = entries_of(table);
    entries.insert(entries.end(), more.begin(), more.end());
    tables_.emplace_back(&table, first);
    return first;
  }
  std::vector<TableEntry> entries;

 private:
  std::vector<std::pair<const FixedTable*, size_t>> tables_;
};

// What the statements of a graph read, where the names of rounds_kernel.h are in sight.
class Reader {
 public:
  Reader(const FixedProgram& program, const graph::Round& round, const Graph& graph, Entries& entries)
      : program_(program), round_(round), graph_(graph), entries_(entries) {}

  graph::Outside outside() const {
    return {[this](const Node& node) { return input(node); },
            [this](const Node& node, const std::string& argument, const std::string& law) {
              return lookup(node, argument, law);
            }};
  }

 private:
  std::string input(const Node& node) const {
    const int a = node.axis, k = node.index;
    switch (node.source) {
      case Source::apart:
        return fmt::format("pair.apart[{}]", a);
      case Source::own_x:
        return fmt::format("at.own_x({}, i)", a);
      case Source::own_v:
        return fmt::format("at.from.v[{}][i]", a);
      case Source::other_v:
        return fmt::format("at.from.v[{}][pair.j]", a);
      case Source::own_u:
        return fmt::format("at.own_u({}, i)", a);
      case Source::own_constant:
        return of_types(k, "at.from.type[i]");
      case Source::other_constant:
        return of_types(k, "pair.other_type");
      case Source::pair_constant:
        return of_pairs(k);
      case Source::own_field:
        return fmt::format("at.from.fields[{}][i]", program_.place(k) + a);
      case Source::other_field:
        return fmt::format("at.from.fields[{}][pair.j]", program_.place(k) + a);
      case Source::bond_field:
        return fmt::format("at.bonds.from[{}][slot]", program_.bond_place(k) + a);
      case Source::bond_constant:
        return fmt::format("at.bonds.constant({}, slot)", k);
      case Source::sum:
        return fmt::format("sums[{}]", round_.place(k) + a);
      case Source::own_id:
        return "at.from.id[i]";
      case Source::other_id:
        return "at.from.id[pair.j]";
      case Source::step:
        return "static_cast<int64_t>(at.step)";
    }
    return {};
  }

  static std::string literal(int64_t number) { return fmt::format("int64_t{{{}}}", number); }
  // Of one type the number itself stands in the text.
  std::string of_types(int k, const char* type) const {
    const std::vector<int64_t>& values = program_.type_constants[static_cast<size_t>(k)].values;
    if (std::count(values.begin(), values.end(), values.front()) == static_cast<ptrdiff_t>(values.size()))
      return literal(values.front());
    return fmt::format("at.type_constants[{} + {}]", k * program_.types, type);
  }
  std::string of_pairs(int k) const {
    const std::vector<int64_t>& values = program_.pair_constants[static_cast<size_t>(k)].values;
    if (std::count(values.begin(), values.end(), values.front()) == static_cast<ptrdiff_t>(values.size()))
      return literal(values.front());
    return fmt::format("at.pair_constants[{} + pair.own_type * {} + pair.other_type]",
                       k * program_.types * program_.types, program_.types);
  }

  std::string lookup(const Node& node, const std::string& argument, const std::string& law) const {
    const FixedTable& t = graph_.tables[static_cast<size_t>(node.table)];
    return fmt::format("EntryTable<{}, {}, {}, {}, {}, {}, {}>::value<{}>(at.entries + {}, {}, {})",
                       static_cast<int>(t.shape), t.degree, t.difference_frac, t.index_bits, t.bin_bits,
                       t.first_octave, t.fraction_bits, is_flat(t), entries_.add(t), argument, law);
  }

  const FixedProgram& program_;
  const graph::Round& round_;
  const Graph& graph_;
  Entries& entries_;
};

// One round.
class RoundText {
 public:
  RoundText(const FixedProgram& program, const graph::Round& round, Entries& entries)
      : program_(program),
        round_(round),
        pair_(program, round, round.pair, entries),
        finish_(program, round, round.finish, entries),
        broken_(program, round, program.broken, entries),
        terms_(terms_of(round)),
        early_(needed_by(round.pair, {round.when})) {
    const std::vector<int> all = needed_by(round.pair, pair_outputs(round));
    std::set_difference(all.begin(), all.end(), early_.begin(), early_.end(), std::back_inserter(late_));
    for (std::vector<int>* list : {&early_, &late_}) take_own(*list);
  }

  std::string text(const std::string& name) const {
    return fmt::format(
        "struct {} {{\n"
        "static constexpr bool kBonded = {};\n"
        "static constexpr int kSums = {};\n"
        "struct Own {{\n{}}};\n"
        "CUBOCT_DEVICE void begin(const RoundsFrame& at, uint32_t i, Own& own) const {{\n{}}}\n"
        "CUBOCT_DEVICE bool pair(const RoundsFrame& at, const Own& own, const RoundsPair& pair, "
        "int64_t (&sums)[kSums], bool& fits) const {{\n{}}}\n"
        "CUBOCT_DEVICE bool broken(const RoundsFrame& at, const Own&, size_t slot) const {{\n{}}}\n"
        "CUBOCT_DEVICE void keep(const RoundsFrame& at, size_t slot) const {{\n{}}}\n"
        "CUBOCT_DEVICE void finish(const RoundsFrame& at, uint32_t i, const Own&, "
        "const int64_t (&sums)[kSums], "
        "RoundsMotion& motion, bool& fits) const {{\n{}}}\n"
        "}};\n",
        name, program_.bonded, std::max<size_t>(terms_.size(), 1), own_members(), begin(), pair(), broken(),
        keep(), finish());
  }

 private:
  // What is the particle's own moves out of the list: it is read once.
  void take_own(std::vector<int>& list) {
    const auto is_own = [&](int n) {
      const Node& node = node_at(round_.pair, n);
      return node.op == Op::input && is_of_own(node.source);
    };
    std::copy_if(list.begin(), list.end(), std::back_inserter(own_), is_own);
    std::erase_if(list, is_own);
  }

  std::string own_members() const {
    std::string text;
    for (const int n : own_) text += fmt::format("{} n{};\n", graph::type_text(node_at(round_.pair, n)), n);
    return text;
  }
  std::string begin() const {
    std::string text = graph::statements(round_.pair, own_, pair_.outside());
    for (const int n : own_) text += fmt::format("own.n{0} = n{0};\n", n);
    return text;
  }
  std::string pair() const {
    const Graph& g = round_.pair;
    std::string text = "const size_t slot = pair.slot;\n";
    for (const int n : own_)
      text += fmt::format("const {0} n{1} = own.n{1};\n", graph::type_text(node_at(g, n)), n);
    text += graph::statements(g, early_, pair_.outside());
    text += fmt::format("if (!{}) return false;\n", value_text(g, round_.when));
    text += graph::statements(g, late_, pair_.outside(), true);
    for (size_t k = 0; k < terms_.size(); ++k)
      text += fmt::format("sums[{}] += {};\n", k, value_text(g, terms_[k]));
    for (const graph::Write& write : round_.bond_writes)
      text += fmt::format("at.bonds.to[{}][slot] = {};\n", program_.bond_place(write.field) + write.component,
                          value_text(g, write.node));
    return text + "return true;\n";
  }
  std::string broken() const {
    if (program_.broken_at < 0) return "return false;\n";
    return "bool fits = true;\n" +
           graph::statements(program_.broken, needed_by(program_.broken, {program_.broken_at}),
                             broken_.outside()) +
           fmt::format("return {} != 0;\n", value_text(program_.broken, program_.broken_at));
  }
  std::string keep() const {
    std::string text;
    for (const graph::Write& write : round_.bond_writes)
      text += fmt::format("at.bonds.keep({}, slot);\n", program_.bond_place(write.field) + write.component);
    return text;
  }
  std::string finish() const {
    const Graph& g = round_.finish;
    const graph::Motion motion = &round_ == &program_.rounds.back() ? program_.motion : graph::Motion{};
    std::string stores;
    for (const graph::Write& write : round_.writes)
      stores += fmt::format("at.to.fields[{}][i] = {};\n", program_.place(write.field) + write.component,
                            value_text(g, write.node));
    const auto move = [&](const char* what, const std::vector<int>& axes) {
      for (size_t a = 0; a < axes.size(); ++a)
        stores += fmt::format("motion.{}[{}] = {};\n", what, a, value_text(g, axes[a]));
    };
    move("v", motion.v), move("drift", motion.drift), move("u", motion.u);
    return graph::statements(g, needed_by(g, finish_outputs(program_, round_)), finish_.outside()) + stores;
  }

  const FixedProgram& program_;
  const graph::Round& round_;
  Reader pair_, finish_, broken_;
  std::vector<int> terms_, early_, late_, own_;
};

}  // namespace

bool is_flat(const FixedTable& table) {
  const auto within = [](int64_t v) { return v == static_cast<int32_t>(v); };
  const int64_t most = (int64_t{1} << table.fraction_bits) - 1;
  for (size_t k = 0; k < table.c2.size(); ++k)
    if (!within(table.c1[k] + round_odd(table.c2[k] * most, table.fraction_bits))) return false;
  return true;
}

std::vector<TableEntry> entries_of(const FixedTable& table) {
  std::vector<TableEntry> entries;
  for (size_t k = 0; k < table.c0.size(); ++k)
    entries.push_back({table.c0[k], table.c1[k], table.degree == 2 ? table.c2[k] : 0, 0});
  return entries;
}

RoundsText text_of(const FixedProgram& program, size_t frame_bytes) {
  RoundsText text;
  Entries entries;
  text.source =
      "#define CUBOCT_ROUNDS_ALONE\n"
      "#include \"emu/gpu/rounds/rounds_kernel.h\"\n"
      "#include \"model/graph/integer_ops.h\"\n"
      "namespace cuboct::gpu {\n";
  std::string kernels;
  for (size_t k = 0; k < program.rounds.size(); ++k) {
    const std::string graphs = fmt::format("Round{}", k);
    text.source += RoundText(program, program.rounds[k], entries).text(graphs);
    text.source += fmt::format("static_assert(sizeof(RoundsStep<{}>) == {});\n", graphs, frame_bytes);
    text.names.push_back(fmt::format("round_{}", k));
    kernels += fmt::format("CUBOCT_ROUND({}, cuboct::gpu::{})\n", text.names.back(), graphs);
  }
  text.source += "}  // namespace cuboct::gpu\n" + kernels;
  text.entries = std::move(entries.entries);
  return text;
}

}  // namespace cuboct::gpu
