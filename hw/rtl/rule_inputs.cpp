// SPDX-License-Identifier: MIT
// What a rule's pipelines read: of the pair's two particles, of their bond, of the step, of constants.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "hw/rtl/rtl_template.h"
#include "hw/rtl/rule_printer.h"

namespace cuboct {
namespace {

// One of several values, by a key.
class Choice {
 public:
  Choice(std::string name, std::string key) : name_(std::move(name)), key_(std::move(key)) {}
  void add(const std::string& key, const std::string& value) {
    cases_ += fmt::format("        {}: {} = {};\n", key, name_, value);
  }
  std::string text(int bits) const {
    return fmt::format(
        "    logic {}{};\n    always_comb begin\n      unique case ({})\n{}"
        "        default: {} = '0;\n      endcase\n    end\n",
        range_text(bits), name_, key_, cases_, name_);
  }

 private:
  std::string name_, key_, cases_;
};

}  // namespace

using graph::Node;
using graph::Source;
using pipeline::Form;

std::string range_text(int bits) { return fmt::format("[{}:0] ", bits - 1); }

// A constant by type, or by both types: a choice that `text` declares.
std::string RulePrinter::types_of(const std::string& own_word, const Node& node, int bits,
                                  const std::string& name, std::string& text) const {
  const bool pair = node.source == Source::pair_constant;
  const auto& constants = pair ? program_.pair_constants : program_.type_constants;
  const std::vector<int64_t>& values = constants[at(node.index)].values;
  if (program_.types == 1) return literal(values[0], bits);
  const bool of_other = node.source == Source::other_constant;
  const int type_bits = plan_.rule.type_bits;
  const std::string own_type = of_other ? "" : words_.own(own_word, FieldKind::type).text();
  const std::string other_type = pair || of_other ? words_.other("candidate_q", FieldKind::type).text() : "";
  Choice choice{name, pair       ? fmt::format("{{{}, {}}}", own_type, other_type)
                      : of_other ? other_type
                                 : own_type};
  for (int k = 0; k < static_cast<int>(values.size()); ++k) {
    const int key = pair ? (k / program_.types) << type_bits | k % program_.types : k;
    choice.add(literal(key, pair ? 2 * type_bits : type_bits), literal(values[at(k)], bits));
  }
  text += choice.text(bits);
  return name;
}

// A constant of a bond, by the kind that stands lowest in `bond`.
std::string RulePrinter::kind_of(const Node& node, int bits, const std::string& name,
                                 std::string& text) const {
  const graph::BondRows& rows = *plan_.program->rows;
  const size_t constants = program_.bond_constants.size();
  const auto value = [&](uint32_t kind) {
    return literal(rows.constants[kind * constants + at(node.index)], bits);
  };
  if (rows.kinds() == 1) return value(0);
  Choice choice{name, fmt::format("bond[{}:0]", words_.kind_bits() - 1)};
  for (uint32_t kind = 0; kind < rows.kinds(); ++kind)
    choice.add(literal(kind, words_.kind_bits()), value(kind));
  text += choice.text(bits);
  return name;
}

std::string RulePrinter::input(const Node& node, int round, bool pair, int bits, std::string& text) {
  const std::string word = pair ? "own" : "slot_q";
  const int axis = node.axis;
  const std::string name = pipeline::port_name(node).substr(0, pipeline::port_name(node).size() - 2);
  const int P = plan_.rule.widths.position_frac, G = plan_.rule.widths.guard;
  switch (node.source) {
    case Source::apart: {
      const Slice mine = words_.own(word, FieldKind::position, axis);
      const Slice theirs{"candidate_q", axis * (P + 2), P + 2, true};
      const int width = std::min(P + 3, bits);  // the input holds every difference: its low bits are enough
      text += fmt::format("    logic {}{};\n    assign {} = {} - {};\n", range_text(width), name, name,
                          theirs.fit(width), mine.fit(width));
      return Slice{name, 0, width, true}.fit(bits);
    }
    case Source::own_x: {
      text += fmt::format("    logic {}{};\n    assign {} = {{{}, {}}};\n", range_text(P + G), name, name,
                          words_.own(word, FieldKind::position, axis).text(),
                          words_.own(word, FieldKind::residue, axis).text());
      return Slice{name, 0, P + G, false}.fit(bits);
    }
    case Source::own_v:
      return words_.own(word, FieldKind::velocity, axis).fit(bits);
    case Source::other_v:
      return words_.other("candidate_q", FieldKind::velocity, axis).fit(bits);
    case Source::own_u:
      return words_.own(word, FieldKind::displacement, axis).fit(bits);
    case Source::own_field:
      return words_.own(word, FieldKind::field, -1, program_.place(node.index) + axis).fit(bits);
    case Source::other_field:
      return words_.other_number("candidate_q", program_.place(node.index) + axis, round).fit(bits);
    case Source::own_id:
      return words_.own(word, FieldKind::id).fit(bits);
    case Source::other_id:
      return words_.other("candidate_q", FieldKind::id).fit(bits);
    case Source::step:
      step_bits_ = std::max(step_bits_, bits);
      return fmt::format("step_q[{}:0]", bits - 1);
    case Source::sum:
      return Slice{fmt::format("total_{}", node.index), axis * sum_bits(round, node.index),
                   sum_bits(round, node.index), true}
          .fit(bits);
    case Source::own_constant:
    case Source::other_constant:
    case Source::pair_constant:
      return types_of(word, node, bits, name, text);
    case Source::bond_field: {
      const WordField& f = words_.bond_field(program_.bond_place(node.index) + axis);
      return Slice{"bond", f.lsb - words_.bond_lsb() - plan_.words.id_bits, f.bits, f.is_signed}.fit(bits);
    }
    case Source::bond_constant:
      return kind_of(node, bits, name, text);
  }
  throw std::logic_error("RTL has no such input");
}

std::string RulePrinter::inputs(const graph::Graph& graph, const pipeline::Schedule& schedule, int round,
                                bool pair, std::string& connections) {
  std::string before, declared, set;
  for (const pipeline::Port& port : schedule.steps.inputs) {
    const Node& node = graph.nodes[at(port.node)];
    const Form form = form_of_step(schedule, port.step);
    const std::string name = pipeline::port_name(node), value = input(node, round, pair, form.bits, before);
    const std::string reg = "in_" + name.substr(0, name.size() - 2) + "_q";
    declared += fmt::format("    logic {}{};\n", range_text(form.bits), reg);
    set += fmt::format("        {} <= {};\n", reg, value);
    connections += fmt::format(",\n      .{}({})", name, reg);
  }
  if (set.empty()) return before;
  return before + declared +
         fmt::format("    always_ff @(posedge clk_i) begin\n      if ({}) begin\n{}      end\n    end\n",
                     pair ? "age_q[1]" : "taken_q", set);
}

}  // namespace cuboct
