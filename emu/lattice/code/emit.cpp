// SPDX-License-Identifier: MIT
#include "emu/lattice/code/emit.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "emu/lattice/code/emit_finish.h"

namespace cuboct::emu {
namespace {

using graph::Node;
using graph::Op;
using graph::Source;

bool is_of_own(Source source) {
  return source == Source::own_v || source == Source::own_field || source == Source::own_constant ||
         source == Source::own_id;
}

// `own` and `other`: where lanes begin; `turned`: the difference is that from the entry's higher end.
struct PairEnds {
  std::string own, other;
  bool turned = false;
};

std::string of_type(const graph::FixedProgram& program, int constant, const std::string& particle) {
  if (program.types == 1) return fmt::format("splat(job.numbers.type_constants[{}][0])", constant);
  return fmt::format("of_type(job.numbers.type_constants[{}], job.type + {})", constant, particle);
}

std::string pair_input(const graph::FixedProgram& program, const PairEnds& ends, const Node& node) {
  const int index = node.index, axis = node.axis;
  switch (node.source) {
    case Source::apart:
      return fmt::format("{}apart[{}]", ends.turned ? "V{} - " : "", axis);
    case Source::own_v:
      return fmt::format("load(job.v[{}] + {})", axis, ends.own);
    case Source::other_v:
      return fmt::format("load(job.v[{}] + {})", axis, ends.other);
    case Source::own_field:
      return fmt::format("load(job.fields[{}] + {})", program.place(index) + axis, ends.own);
    case Source::other_field:
      return fmt::format("load(job.fields[{}] + {})", program.place(index) + axis, ends.other);
    case Source::own_constant:
      return of_type(program, index, ends.own);
    case Source::other_constant:
      return of_type(program, index, ends.other);
    case Source::pair_constant:
      if (program.types == 1) return fmt::format("splat(job.numbers.pair_constants[{}][0])", index);
      return fmt::format(
          "of_types(job.numbers.pair_constants[{}], job.type + {}, job.type + {}, job.numbers.types)", index,
          ends.own, ends.other);
    case Source::own_id:
      return fmt::format("ids(job.id, {})", ends.own);
    case Source::other_id:
      return fmt::format("ids(job.id, {})", ends.other);
    case Source::step:
      return "splat(job.step)";
    case Source::bond_field:
      return fmt::format("load(job.bonds[{}] + slot)", program.bond_place(index) + axis);
    case Source::bond_constant:
      return fmt::format("kinds(job.bond_constants + {})", index);
    default:
      throw std::logic_error(std::string("a pair has no ") + to_string(node.source));
  }
}

// What a particle's own numbers alone make: it is worked out once for all of its entries.
std::vector<int> own_alone(const graph::Graph& graph, const std::vector<int>& nodes) {
  std::vector<int> own;
  const auto is_constant = [&](int n) { return graph.nodes[static_cast<size_t>(n)].op == Op::constant; };
  for (const int n : nodes) {
    const Node& node = graph.nodes[static_cast<size_t>(n)];
    const bool follows =
        node.op != Op::input && node.op != Op::check && std::ranges::all_of(node.inputs, [&](int input) {
          return is_constant(input) || std::ranges::binary_search(own, input);
        });
    if (is_constant(n) || (node.op == Op::input && is_of_own(node.source)) || follows) own.push_back(n);
  }
  return own;
}

// Ends of bonds that are a cell or more apart along an axis.
constexpr const char* kMeetFarEnds = R"(
        W far = W{};
        for (const V& along : apart) far |= magnitude(along) >= splat(job.cell);
        far &= near;
        if (__builtin_expect(any(far), 0))
          for (int l = 0; l < kLanes; ++l) {
            if (far[l] == 0) continue;
            double ends[3] = {apart[0][l], apart[1][l], apart[2][l]};
            if (!job.meet(job.owner, static_cast<uint32_t>(i) + l, static_cast<uint32_t>(j) + l, slot + l, ends))
              near[l] = 0;
            for (int a = 0; a < 3; ++a) apart[a][l] = ends[a];
          }
)";

std::string take_bonds(const graph::FixedProgram& program, const graph::Round& round, const GraphText& pair) {
  if (round.bond_writes.empty()) return {};
  std::string text = "        W changed = W{};\n";
  for (const graph::Write& write : round.bond_writes) {
    const int number = program.bond_place(write.field) + write.component;
    text += fmt::format(
        "        {{\n"
        "          const V before = load(job.bonds[{0}] + slot), after = select(near, {1}, before);\n"
        "          changed |= before != after;\n"
        "          store(job.bonds[{0}] + slot, after);\n"
        "        }}\n",
        number, pair.value(write.node));
  }
  text +=
      "        if (job.changed != nullptr && any(changed))\n"
      "          for (int l = 0; l < kLanes; ++l)\n"
      "            if (changed[l] != 0)\n"
      "              job.changed(job.owner, static_cast<uint32_t>(i) + l, static_cast<uint32_t>(j) + l);\n";
  return text;
}

// `sum` takes the term of lanes that are near, with `sign` times its own.
std::string take_term(const GraphText::Term& term, size_t t, const std::string& sum, bool minus) {
  if (term.rounds) return fmt::format("fused(product{}, {}{}, {})", t, minus ? "-" : "", term.factor, sum);
  return fmt::format("{} {} product{}", sum, (term.sign < 0) != minus ? "-" : "+", t);
}

std::string round_text(const graph::FixedProgram& program, size_t k, Ends ends, size_t first_table,
                       CodeConstants& constants) {
  const graph::Round& round = program.rounds[k];
  const PairParts parts(round);
  const bool turned = ends == Ends::other;
  const PairEnds where = turned ? PairEnds{"j", "i", true} : PairEnds{"i", "j", false};
  const Surroundings surroundings{[&](const Node& node) { return pair_input(program, where, node); }, "near",
                                  first_table, true};
  const GraphText pair(round.pair, constants, surroundings);
  std::vector<int> written;
  for (const graph::Write& write : round.bond_writes) written.push_back(write.node);
  std::vector<int> all = parts.early, late;
  const std::vector<int> needed = pair.needed_by_terms(parts.terms, written);
  std::ranges::set_difference(needed, parts.early, std::back_inserter(late));
  all.insert(all.end(), late.begin(), late.end());
  std::ranges::sort(all);
  const std::vector<int> own = turned ? std::vector<int>() : own_alone(round.pair, all);
  const auto rest = [&](const std::vector<int>& nodes) {
    std::vector<int> others;
    std::ranges::set_difference(nodes, own, std::back_inserter(others));
    return others;
  };

  std::string text = fmt::format(
      "extern \"C\" void {}(const Job& job) {{\n"
      "  const double* const __restrict K = job.numbers.constants;\n"
      "  const CodeTable* const __restrict T = job.numbers.tables;\n"
      "  static_cast<void>(K), static_cast<void>(T);\n"
      "  W bad = W{{}};\n"
      "  for (uint32_t n = 0; n < job.count; ++n) {{\n"
      "    const uint32_t g = job.chosen != nullptr ? job.chosen[n] : job.first + n;\n"
      "    const uint32_t group = job.group_of != nullptr ? job.group_of[g] : g;\n"
      "    if (job.wanted != nullptr && job.wanted[group] == 0) continue;\n"
      "    const EntryGroup of = job.groups[g];\n"
      "    if (of.near == 0) continue;\n"
      "    const uint32_t place = (job.group_of != nullptr ? g : group) * kEntryLanes & job.mask;\n"
      "    for (uint32_t at = 0; at < kEntryLanes; at += kLanes) {{\n"
      "      const ptrdiff_t i = job.begin + ptrdiff_t{{group}} * kEntryLanes + at;\n"
      "      const V x[3] = {{load(job.x[0] + i), load(job.x[1] + i), load(job.x[2] + i)}};\n",
      name_of(k, ends));
  text += pair.statements(own, true, "      ");
  if (!turned)
    for (size_t t = 0; t < parts.terms.size(); ++t)
      text += fmt::format("      V sum{} = V{{}} + kMagic;\n", t);
  text +=
      "      for (uint32_t e = of.begin; e != of.begin + of.near; ++e) {\n"
      "        const Entry& entry = job.entries[e];\n"
      "        const uint32_t bits = entry.lanes >> at & ((1u << kLanes) - 1);\n"
      "        if (bits == 0) continue;\n"
      "        const ptrdiff_t j = ptrdiff_t{entry.first} + at;\n"
      "        W near = lanes_of(bits);\n"
      "        V apart[3];\n"
      "        for (int a = 0; a < 3; ++a) apart[a] = load(job.x[a] + j) - x[a];\n"
      "        if (__builtin_expect(entry.shift != kNoShift, 0))\n"
      "          for (int a = 0; a < 3; ++a) apart[a] = apart[a] + splat(job.shift[entry.shift][a]);\n";
  if (program.bonded)
    text += fmt::format(
        "        const size_t slot = size_t{{e}} * kEntryLanes + at;\n"
        "        const Kinds kinds(job.kind + slot, job.bond_constant_count);{}",
        kMeetFarEnds);
  text += pair.statements(rest(parts.early), false, "        ");
  text += fmt::format(
      "        near &= {};\n"
      "        if (!any(near)) continue;\n",
      pair.truth(round.when));
  text += pair.statements(rest(late), true, "        ");
  if (std::ranges::any_of(
          late, [&](int n) { return round.pair.nodes[static_cast<size_t>(n)].op == graph::Op::check; }))
    text +=
        "        if (__builtin_expect(any(bad), 0)) {\n"
        "          for (int l = 0; l < kLanes; ++l)\n"
        "            if (bad[l] != 0)\n"
        "              job.misfit(job.owner, static_cast<uint32_t>(i) + l, static_cast<uint32_t>(j) + l, "
        "entry,\n"
        "                         size_t{e} * kEntryLanes + at + l);\n"
        "          bad = W{};\n"
        "        }\n";
  for (size_t t = 0; t < parts.terms.size(); ++t) {
    const GraphText::Term term = pair.term(parts.terms[t]);
    text += fmt::format("        const V product{} = select(near, {}, V{{}});\n", t, term.product);
    if (!turned)
      text += fmt::format("        sum{0} = {1};\n", t, take_term(term, t, fmt::format("sum{}", t), false));
    if (ends != Ends::own)
      text += fmt::format(
          "        {{\n"
          "          double* const to = job.sums[{0}] + ((j - job.begin) & job.mask);\n"
          "          store(to, {1});\n"
          "        }}\n",
          t, take_term(term, t, "load(to)", !turned && parts.signs[t] < 0));
  }
  if (program.bonded) text += take_bonds(program, round, pair);
  text += "      }\n";
  if (!turned)
    for (size_t t = 0; t < parts.terms.size(); ++t)
      text += fmt::format(
          "      {{\n"
          "        double* const to = job.sums[{0}] + place + at;\n"
          "        store(to, load(to) + (sum{0} - splat(kMagic)));\n"
          "      }}\n",
          t);
  return text + "    }\n  }\n}\n\n";
}

}  // namespace

std::string name_of(size_t round, Ends ends) {
  return fmt::format("cuboct_round_{}_{}", round,
                     ends == Ends::own     ? "own"
                     : ends == Ends::other ? "other"
                                           : "both");
}

Code code_of(const graph::FixedProgram& program, bool once) {
  Code code;
  CodeConstants constants(code.constants, code.seeds);
  code.text =
      "#include \"emu/lattice/code/lanes.h\"\n#include \"emu/lattice/code/motion.h\"\n\n"
      "namespace cuboct::emu {\n\n";
  size_t tables = 0;
  for (size_t k = 0; k < program.rounds.size(); ++k) {
    const graph::Round& round = program.rounds[k];
    for (const Ends ends : {Ends::own, Ends::other, Ends::both})
      if (ends == Ends::own || (once ? ends == Ends::both : !program.bonded && ends == Ends::other))
        code.text += round_text(program, k, ends, tables, constants);
    tables += round.pair.tables.size();
    code.text += finish_text(program, k, tables, constants);
    tables += round.finish.tables.size();
  }
  code.text += "}  // namespace cuboct::emu\n";
  return code;
}

}  // namespace cuboct::emu
