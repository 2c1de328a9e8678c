// SPDX-License-Identifier: MIT
#include "model/graph/certificate.h"

#include <fmt/format.h>

#include <iterator>

namespace cuboct::graph {
namespace {

using Text = fmt::memory_buffer;

template <class... Args>
void put(Text& to, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(to), format, std::forward<Args>(args)...);
}

void put_table(Text& to, size_t number, const FixedTable& t) {
  put(to, "table {} {} degree {} D {} index {} bins {} first {} T {}\n", number,
      t.shape == TableShape::uniform ? "uniform" : "octaves", t.degree, t.difference_frac, t.index_bits,
      t.bin_bits, t.first_octave, t.fraction_bits);
  for (size_t k = 0; k < t.c0.size(); ++k)
    put(to, "entry {} {} {}\n", t.c0[k], t.c1[k], t.degree == 2 ? t.c2[k] : 0);
}

void put_node(Text& to, size_t number, const Node& node) {
  put(to, "{} {}", number, to_string(node.op));
  if (node.op == Op::input) put(to, " {} {} {}", to_string(node.source), node.index, node.axis);
  for (const int input : node.inputs) put(to, " {}", input);
  if (node.op == Op::constant || node.op == Op::noise) put(to, " number {}", node.number);
  if (node.shift != 0) put(to, " shift {}", node.shift);
  if (node.width != 0) put(to, " width {}", node.width);
  if (node.table >= 0) put(to, " table {}", node.table);
  put(to, " in {} {}", node.range.low, node.range.high);
  if (!node.name.empty()) put(to, " # {}", node.name);
  put(to, "\n");
}

void put_graph(Text& to, const Graph& graph) {
  for (size_t k = 0; k < graph.tables.size(); ++k) put_table(to, k, graph.tables[k]);
  for (size_t k = 0; k < graph.nodes.size(); ++k) put_node(to, k, graph.nodes[k]);
}

void put_writes(Text& to, const char* what, const std::vector<Write>& writes) {
  for (const Write& write : writes) put(to, "write {} {} from {}\n", what, write.field, write.node);
}

void put_motion(Text& to, const Motion& motion) {
  for (const int node : motion.v) put(to, "write velocity 0 from {}\n", node);
  for (const int node : motion.u) put(to, "write displacement 0 from {}\n", node);
  for (const int node : motion.drift) put(to, "write drift 0 from {}\n", node);
}

void put_formats(Text& to, const FixedProgram& program) {
  const auto format = [&](const char* what, size_t index, Interval range) {
    put(to, "format {} {} in {} {}\n", what, index, range.low, range.high);
  };
  const int64_t cell = int64_t{1} << (program.position_frac + program.guard);
  format("velocity", 0, program.velocity);
  format("displacement", 0, program.displacement);
  format("drift", 0, {-cell, cell});
  for (size_t k = 0; k < program.fields.size(); ++k) format("field", k, program.fields[k].range);
  for (size_t k = 0; k < program.bonds.size(); ++k) format("bond", k, program.bonds[k].range);
}

}  // namespace

std::string certificate_of(const FixedProgram& program) {
  Text text;
  put(text, "partners {}\n", program.partners);
  put_formats(text, program);
  if (program.broken_at >= 0) {
    put(text, "pair\n");
    put_graph(text, program.broken);
  }
  for (const Round& round : program.rounds) {
    put(text, "pair\n");
    put_graph(text, round.pair);
    for (size_t s = 0; s < round.sums.size(); ++s)
      for (size_t c = 0; c < round.sums[s].terms.size(); ++c)
        put(text, "sum {} {} from {}\n", s, c, round.sums[s].terms[c]);
    put_writes(text, "bond", round.bond_writes);
    put(text, "finish\n");
    put_graph(text, round.finish);
    put_writes(text, "field", round.writes);
  }
  put_motion(text, program.motion);
  return fmt::to_string(text);
}

}  // namespace cuboct::graph
