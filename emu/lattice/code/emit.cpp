// SPDX-License-Identifier: MIT
#include "emu/lattice/code/emit.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "emu/lattice/kernel_rule.h"

namespace cuboct::emu {
namespace {

using graph::Node;
using graph::Op;
using graph::Source;

class Constants {
 public:
  explicit Constants(std::vector<double>& values) : values_(values) {}
  std::string operator()(double value) {
    const auto same = std::ranges::find_if(
        values_, [&](double v) { return std::bit_cast<uint64_t>(v) == std::bit_cast<uint64_t>(value); });
    const auto at = same - values_.begin();
    if (same == values_.end()) values_.push_back(value);
    return fmt::format("splat(K[{}])", at);
  }

 private:
  std::vector<double>& values_;
};

bool is_truth(const Node& node) {
  switch (node.op) {
    case Op::lt:
    case Op::le:
    case Op::eq:
    case Op::both:
    case Op::either:
    case Op::negate:
      return true;
    default:
      return false;
  }
}

bool is_of_own(Source source) {
  return source == Source::own_v || source == Source::own_field || source == Source::own_constant ||
         source == Source::own_id;
}

// A pair's graph. Values of node n are `v<n>`, its truths `w<n>`.
class PairText {
 public:
  PairText(const graph::FixedProgram& program, const graph::Round& round, size_t first_table,
           Constants& constants)
      : program_(program), graph_(round.pair), first_table_(first_table), constant_(constants) {}

  // `own` and `other`: where lanes begin; `sign` of the difference from the entry's lower end.
  void ends(std::string own, std::string other, bool turned) {
    own_ = std::move(own), other_ = std::move(other), turned_ = turned;
  }

  // Of nodes in order. `late`: all pairs count.
  std::string statements(const std::vector<int>& nodes, bool late, const std::string& indent) const {
    std::string text;
    for (const int n : nodes) {
      const Node& node = at(n);
      if (is_truth(node))
        text += fmt::format("{}const W w{} = {};\n", indent, n, truth_text(node));
      else
        text += fmt::format("{}const V v{} = {};\n", indent, n, value_text(node, late));
    }
    return text;
  }
  std::string value(int n) const {
    return is_truth(at(n)) ? fmt::format("value_of(w{})", n) : fmt::format("v{}", n);
  }
  std::string truth(int n) const {
    return is_truth(at(n)) ? fmt::format("w{}", n) : fmt::format("truth_of(v{})", n);
  }

 private:
  const Node& at(int n) const { return graph_.nodes[static_cast<size_t>(n)]; }

  std::string truth_text(const Node& node) const {
    const auto in = [&](size_t k) { return node.inputs[k]; };
    switch (node.op) {
      case Op::lt:
        return fmt::format("{} < {}", value(in(0)), value(in(1)));
      case Op::le:
        return fmt::format("{} <= {}", value(in(0)), value(in(1)));
      case Op::eq:
        return fmt::format("{} == {}", value(in(0)), value(in(1)));
      case Op::both:
        return fmt::format("{} & {}", truth(in(0)), truth(in(1)));
      case Op::either:
        return fmt::format("{} | {}", truth(in(0)), truth(in(1)));
      default:
        return fmt::format("~{}", truth(in(0)));
    }
  }

  std::string rounded(const std::string& value, int shift) const {
    if (shift == 0) return value;
    return fmt::format("rounded({}, {})", value, constant_(rounding_factor(shift)));
  }

  std::string value_text(const Node& node, bool late) const {
    const auto in = [&](size_t k) { return value(node.inputs[k]); };
    const auto range = [&](const std::string& a) {
      return fmt::format("least(most({}, {}), {})", a, constant_(static_cast<double>(node.range.low)),
                         constant_(static_cast<double>(node.range.high)));
    };
    switch (node.op) {
      case Op::constant:
        return constant_(static_cast<double>(node.number));
      case Op::input:
        return input_text(node);
      case Op::add:
        return fmt::format("{} + {}", in(0), in(1));
      case Op::sub:
        return fmt::format("{} - {}", in(0), in(1));
      case Op::neg:
        return fmt::format("V{{}} - {}", in(0));
      case Op::shl:
        return fmt::format("{} * {}", in(0), constant_(std::ldexp(1.0, node.shift)));
      case Op::round:
        return rounded(in(0), node.shift);
      case Op::floor:
        return fmt::format("floor_of({} * {})", in(0), constant_(std::ldexp(1.0, -node.shift)));
      case Op::mul:
        return rounded(fmt::format("{} * {}", in(0), in(1)), node.shift);
      case Op::mac:
        return fmt::format("{} + {}", in(0), rounded(fmt::format("{} * {}", in(1), in(2)), node.shift));
      case Op::dot: {
        std::string sum;
        const size_t count = node.inputs.size() / 2;
        for (size_t k = 0; k < count; ++k)
          sum += fmt::format("{}{} * {}", k > 0 ? " + " : "", in(k), in(count + k));
        return rounded(sum, node.shift);
      }
      case Op::lookup: {
        const FixedTable& table = graph_.tables[static_cast<size_t>(node.table)];
        const Node& law = at(node.inputs[1]);
        const std::string name = fmt::format("T[{}]", first_table_ + static_cast<size_t>(node.table));
        return fmt::format(
            "lookup<{}, {}>({}, {}, {})", table.shape == TableShape::octaves ? "true" : "false", table.degree,
            name, in(0),
            law.op == Op::constant && law.number == 0 ? "W{}" : fmt::format("law_of({}, {})", in(1), name));
      }
      case Op::select:
        return fmt::format("select({}, {}, {})", truth(node.inputs[0]), in(1), in(2));
      case Op::min:
        return fmt::format("least({}, {})", in(0), in(1));
      case Op::max:
        return fmt::format("most({}, {})", in(0), in(1));
      case Op::abs:
        return fmt::format("magnitude({})", in(0));
      case Op::clamp:
        return range(in(0));
      case Op::within:
        return late ? in(0) : range(in(0));
      case Op::msb:
        return fmt::format("leading({})", in(0));
      case Op::align:
        return fmt::format("aligned({}, {}, {})", in(0), node.shift, node.width);
      case Op::shift:
        return fmt::format("shifted({}, {})", in(0), in(1));
      case Op::check:
        return fmt::format("checked({}, {}, near & {}, bad)", in(0),
                           constant_(-std::ldexp(1.0, node.width - 1)), truth(node.inputs[1]));
      case Op::noise:
        return fmt::format("noise({}, {}, {}, {}, {})", node.number, in(0), in(1), in(2), node.width);
      default:
        throw std::logic_error("a truth is no number");
    }
  }

  std::string input_text(const Node& node) const {
    const int index = node.index, axis = node.axis;
    switch (node.source) {
      case Source::apart:
        return fmt::format("{}apart[{}]", turned_ ? "V{} - " : "", axis);
      case Source::own_v:
        return fmt::format("load(job.v[{}] + {})", axis, own_);
      case Source::other_v:
        return fmt::format("load(job.v[{}] + {})", axis, other_);
      case Source::own_field:
        return fmt::format("load(job.fields[{}] + {})", program_.place(index) + axis, own_);
      case Source::other_field:
        return fmt::format("load(job.fields[{}] + {})", program_.place(index) + axis, other_);
      case Source::own_constant:
        return of_type(index, own_);
      case Source::other_constant:
        return of_type(index, other_);
      case Source::pair_constant:
        if (program_.types == 1) return fmt::format("splat(job.pair_constants[{}][0])", index);
        return fmt::format("of_types(job.pair_constants[{}], job.type + {}, job.type + {}, job.types)", index,
                           own_, other_);
      case Source::own_id:
        return fmt::format("ids(job.id, {})", own_);
      case Source::other_id:
        return fmt::format("ids(job.id, {})", other_);
      case Source::step:
        return "splat(job.step)";
      case Source::bond_field:
        return fmt::format("load(job.bonds[{}] + slot)", program_.bond_place(index) + axis);
      case Source::bond_constant:
        return fmt::format("kinds(job.bond_constants + {})", index);
      default:
        throw std::logic_error(std::string("a pair has no ") + to_string(node.source));
    }
  }
  std::string of_type(int constant, const std::string& particle) const {
    if (program_.types == 1) return fmt::format("splat(job.type_constants[{}][0])", constant);
    return fmt::format("of_type(job.type_constants[{}], job.type + {})", constant, particle);
  }

  const graph::FixedProgram& program_;
  const graph::Graph& graph_;
  size_t first_table_;
  Constants& constant_;
  std::string own_, other_;
  bool turned_ = false;
};

// What a particle's own numbers alone make: it is worked out once for all of its entries.
std::vector<int> own_alone(const graph::Graph& graph, const PairParts& parts) {
  std::vector<int> nodes, own;
  std::ranges::merge(parts.early, parts.late, std::back_inserter(nodes));
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
            bool fits = true;
            if (!job.meet(job.owner, static_cast<uint32_t>(i) + l, slot + l, ends, &fits)) near[l] = 0;
            if (!fits) bad[l] = -1;
            for (int a = 0; a < 3; ++a) apart[a][l] = ends[a];
          }
)";

std::string take_bonds(const graph::FixedProgram& program, const graph::Round& round, const PairText& pair) {
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

std::string round_text(const graph::FixedProgram& program, size_t k, Ends ends, size_t first_table,
                       Constants& constants) {
  const graph::Round& round = program.rounds[k];
  const PairParts parts(round);
  PairText pair(program, round, first_table, constants);
  const bool turned = ends == Ends::other;
  pair.ends(turned ? "j" : "i", turned ? "i" : "j", turned);
  const std::vector<int> own = turned ? std::vector<int>() : own_alone(round.pair, parts);
  const auto rest = [&](const std::vector<int>& nodes) {
    std::vector<int> others;
    std::ranges::set_difference(nodes, own, std::back_inserter(others));
    return others;
  };
  const std::vector<int> early = rest(parts.early), late = rest(parts.late);

  std::string text = fmt::format(
      "extern \"C\" bool {}(const Job& job) {{\n"
      "  const double* const __restrict K = job.constants;\n"
      "  const CodeTable* const __restrict T = job.tables;\n"
      "  static_cast<void>(K), static_cast<void>(T);\n"
      "  W bad = W{{}};\n"
      "  for (uint32_t g = 0; g < job.group_count; ++g) {{\n"
      "    const uint32_t group = job.group_of != nullptr ? job.group_of[g] : g;\n"
      "    if (job.wanted != nullptr && job.wanted[group] == 0) continue;\n"
      "    const EntryGroup of = job.groups[g];\n"
      "    for (uint32_t at = 0; at < kEntryLanes; at += kLanes) {{\n"
      "      const ptrdiff_t i = job.begin + ptrdiff_t{{group}} * kEntryLanes + at;\n"
      "      const V x[3] = {{load(job.x[0] + i), load(job.x[1] + i), load(job.x[2] + i)}};\n",
      name_of(k, ends));
  text += pair.statements(own, true, "      ");
  if (!turned)
    for (size_t t = 0; t < parts.terms.size(); ++t) text += fmt::format("      V sum{} = V{{}};\n", t);
  text +=
      "      for (uint32_t e = of.begin; e != of.begin + of.near; ++e) {\n"
      "        const Entry& entry = job.entries[e];\n"
      "        const uint32_t bits = entry.lanes >> at & ((1u << kLanes) - 1);\n"
      "        if (bits == 0) continue;\n"
      "        const ptrdiff_t j = ptrdiff_t{entry.first} + at;\n"
      "        W near = lanes_of(bits);\n"
      "        V apart[3];\n"
      "        for (int a = 0; a < 3; ++a)\n"
      "          apart[a] = load(job.x[a] + j) - x[a] + splat(job.shift[entry.shift][a]);\n";
  if (program.bonded)
    text += fmt::format(
        "        const size_t slot = size_t{{e}} * kEntryLanes + at;\n"
        "        const Kinds kinds(job.kind + slot, job.bond_constant_count);{}",
        kMeetFarEnds);
  text += pair.statements(early, false, "        ");
  text += fmt::format(
      "        near &= {};\n"
      "        if (!any(near)) continue;\n",
      pair.truth(round.when));
  text += pair.statements(late, true, "        ");
  for (size_t t = 0; t < parts.terms.size(); ++t) {
    text += fmt::format("        const V term{} = select(near, {}, V{{}});\n", t, pair.value(parts.terms[t]));
    if (!turned) text += fmt::format("        sum{0} = sum{0} + term{0};\n", t);
    if (ends != Ends::own)
      text += fmt::format(
          "        {{\n"
          "          double* const to = job.sums[{0}] + (j - job.begin);\n"
          "          store(to, load(to) {1} term{0});\n"
          "        }}\n",
          t, !turned && parts.signs[t] < 0 ? "-" : "+");
  }
  if (program.bonded) text += take_bonds(program, round, pair);
  text += "      }\n";
  if (!turned)
    for (size_t t = 0; t < parts.terms.size(); ++t)
      text += fmt::format(
          "      {{\n"
          "        double* const to = job.sums[{0}] + (i - job.begin);\n"
          "        store(to, load(to) + sum{0});\n"
          "      }}\n",
          t);
  return text + "    }\n  }\n  return !any(bad);\n}\n\n";
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
  Constants constants(code.constants);
  code.text = "#include \"emu/lattice/code/lanes.h\"\n\nnamespace cuboct::emu {\n\n";
  size_t tables = 0;
  for (size_t k = 0; k < program.rounds.size(); ++k) {
    for (const Ends ends : {Ends::own, Ends::other, Ends::both})
      if (ends == Ends::own || (once ? ends == Ends::both : !program.bonded && ends == Ends::other))
        code.text += round_text(program, k, ends, tables, constants);
    tables += program.rounds[k].pair.tables.size();
  }
  code.text += "}  // namespace cuboct::emu\n";
  return code;
}

}  // namespace cuboct::emu
