// SPDX-License-Identifier: MIT
#include "emu/lattice/code/emit_finish.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace cuboct::emu {
namespace {

using graph::Node;
using graph::Op;
using graph::Source;

std::string finish_input(const graph::FixedProgram& program, const graph::Round& round, const Node& node) {
  const int index = node.index, axis = node.axis;
  switch (node.source) {
    case Source::sum:
      return fmt::format("load(job.sums[{}] + ((i - job.begin) & job.mask)) - splat(kMagic)",
                         round.place(index) + axis);
    case Source::own_x:
      return fmt::format("place_in_cell(job, {}, i)", axis);
    case Source::own_v:
      return fmt::format("load(job.v[{}] + i)", axis);
    case Source::own_u:
      return fmt::format("(job.u[{0}] != nullptr ? load(job.u[{0}] + i) : V{{}})", axis);
    case Source::own_field:
      return fmt::format("load(job.fields[{}] + i)", program.place(index) + axis);
    case Source::own_constant:
      if (program.types == 1) return fmt::format("splat(job.numbers.type_constants[{}][0])", index);
      return fmt::format("of_type(job.numbers.type_constants[{}], job.type + i)", index);
    case Source::own_id:
      return "ids(job.id, i)";
    case Source::step:
      return "splat(job.step)";
    default:
      throw std::logic_error(std::string("a finish has no ") + to_string(node.source));
  }
}

// Lanes that do not fit are told, and then none of them is written.
constexpr const char* kTellMisfits =
    "      if (__builtin_expect(any(bad), 0)) {\n"
    "        job.misfit(job.owner, static_cast<uint32_t>(i), kLanes);\n"
    "        bad = W{};\n"
    "        continue;\n"
    "      }\n";

bool has_check(const graph::Graph& graph, const std::vector<int>& nodes) {
  return std::ranges::any_of(nodes,
                             [&](int n) { return graph.nodes[static_cast<size_t>(n)].op == Op::check; });
}

std::string keep_all(const graph::FixedProgram& program, const graph::Round& round, const GraphText& finish) {
  std::string text = "      Moved moved;\n";
  for (const graph::Write& write : round.writes)
    text += fmt::format("      keep(job.fields[{}] + i, {}, awake, moved);\n",
                        program.place(write.field) + write.component, finish.value(write.node));
  return text;
}

std::string move_all(const graph::Motion& motion, const GraphText& finish) {
  std::string text;
  for (size_t a = 0; a < motion.v.size(); ++a) {
    text += fmt::format("      move_axis(job, {}, i, awake, {}, {}, moved);\n", a, finish.value(motion.v[a]),
                        finish.value(motion.drift[a]));
    text += fmt::format("      if (job.u[{0}] != nullptr) keep(job.u[{0}] + i, {1}, awake, moved);\n", a,
                        motion.u.empty() ? "V{}" : finish.value(motion.u[a]));
  }
  return text + "      fastest2 = faster(moved, awake, fastest2);\n";
}

}  // namespace

std::string name_of_finish(size_t round) { return fmt::format("cuboct_finish_{}", round); }

std::string finish_text(const graph::FixedProgram& program, size_t k, size_t first_table,
                        CodeConstants& constants) {
  const graph::Round& round = program.rounds[k];
  const bool last = k + 1 == program.rounds.size();
  const Surroundings surroundings{[&](const Node& node) { return finish_input(program, round, node); },
                                  "awake", first_table};
  const GraphText finish(round.finish, constants, surroundings);
  const std::vector<int> nodes = needed_by(round.finish, finish_outputs(program, round));
  std::string text = fmt::format(
      "extern \"C\" void {}(const FinishJob& job) {{\n"
      "  const double* const __restrict K = job.numbers.constants;\n"
      "  const CodeTable* const __restrict T = job.numbers.tables;\n"
      "  static_cast<void>(K), static_cast<void>(T);\n"
      "  W bad = W{{}};\n"
      "  V fastest2 = V{{}};\n"
      "  for (uint32_t n = 0; n < job.count; ++n) {{\n"
      "    const ptrdiff_t group = job.chosen != nullptr ? job.chosen[n] : job.first + n;\n"
      "    for (ptrdiff_t at = 0; at < kEntryLanes; at += kLanes) {{\n"
      "      const ptrdiff_t i = job.begin + group * kEntryLanes + at;\n"
      "      const W awake = awake_lanes(job, i);\n"
      "      if (!any(awake)) continue;\n",
      name_of_finish(k));
  text += finish.statements(nodes, false, "      ");
  text += has_check(round.finish, nodes) ? kTellMisfits : "      static_cast<void>(bad);\n";
  text += keep_all(program, round, finish);
  if (last) text += move_all(program.motion, finish);
  return text +
         "      tell(job, i, moved);\n"
         "    }\n"
         "  }\n"
         "  tell_fastest(job, fastest2);\n"
         "}\n\n";
}

}  // namespace cuboct::emu
