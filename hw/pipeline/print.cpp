// SPDX-License-Identifier: MIT
#include "hw/pipeline/print.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <set>
#include <stdexcept>

#include "hw/pipeline/layout.h"
#include "hw/pipeline/schedule_check.h"

namespace cuboct::pipeline {
namespace {

std::string range_text(int bits) { return bits == 1 ? std::string() : fmt::format("[{}:0] ", bits - 1); }

// `value` is extended by the sign of its 64 bits.
std::string literal(uint64_t value, int bits) {
  if (bits > 64) {
    const char* fill = static_cast<int64_t>(value) < 0 ? "1'b1" : "1'b0";
    return fmt::format("{{{{{}{{{}}}}}, 64'h{:x}}}", bits - 64, fill, value);
  }
  const uint64_t mask = bits == 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
  return fmt::format("{}'h{:x}", bits, value & mask);
}

class Printer {
 public:
  Printer(const std::string& name, const graph::Graph& graph, const Outputs& outputs,
          const Schedule& schedule)
      : name_(name), graph_(graph), outputs_(outputs), s_(schedule), layout_(layout_of(schedule)) {}

  std::vector<Module> modules() {
    std::vector<Module> all{{name_, {}}};
    print_steps();
    std::string& text = all[0].text;
    text = fmt::format(
        "// SPDX-License-Identifier: MIT\n"
        "// One set of inputs per cycle; its outputs {} cycle{} later. The ports of "
        "docs/reference/pipeline.md.\n"
        "module {} (\n{});\n",
        s_.cycles, s_.cycles == 1 ? "" : "s", name_, ports());
    text += fmt::format("{}\n{}", declared_, assigned_);
    if (!clocked_.empty()) text += "  always_ff @(posedge clk_i) begin\n" + clocked_ + "  end\n\n";
    text += valid() + outputs_text();
    if (!unused_.empty()) {
      text += "\n  logic unused_bits;\n  assign unused_bits = ^{";
      for (size_t k = 0; k < unused_.size(); ++k)
        text += fmt::format("{}{}", k == 0 ? "" : k % 8 == 0 ? ",\n    " : ", ", unused_[k]);
      text += "};\n";
    }
    text += "endmodule\n";
    for (const int table : tables_) all.push_back({rom_name(table), rom(table)});
    return all;
  }

 private:
  const Step& step(int k) const { return s_.steps.steps[static_cast<size_t>(k)]; }
  int done(int k) const { return s_.at[static_cast<size_t>(k)].cycle; }
  const graph::Node& node(int n) const { return graph_.nodes[static_cast<size_t>(n)]; }
  std::string rom_name(int table) const { return fmt::format("{}_rom{}", name_, table); }

  // Which port an input step is.
  std::string port_of(int k) const {
    const auto port = std::ranges::find(s_.steps.inputs, k, &Port::step);
    return port_name(node(port->node));
  }

  std::string port(bool output, int k, const std::string& name) const {
    const Step& of = step(k);
    return fmt::format("  {} logic {}{}{}", output ? "output" : "input ", of.is_signed ? "signed " : "",
                       range_text(of.bits), name);
  }

  std::string ports() const {
    std::vector<std::string> lines{"  input  logic clk_i", "  input  logic rst_ni", "  input  logic valid_i"};
    for (const Port& p : s_.steps.inputs) lines.push_back(port(false, p.step, port_of(p.step)));
    lines.emplace_back("  output logic valid_o");
    for (size_t k = 0; k < s_.steps.outputs.size(); ++k)
      lines.push_back(port(true, s_.steps.outputs[k].step, outputs_.names[k] + "_o"));
    if (s_.steps.fault >= 0) {
      lines.push_back(port(true, s_.steps.fault, "fault_valid_o"));
      lines.push_back(port(true, s_.steps.fault_code, "fault_code_o"));
      lines.push_back(port(true, s_.steps.fault_number, "fault_number_o"));
    }
    std::string text;
    for (size_t k = 0; k < lines.size(); ++k) text += lines[k] + (k + 1 < lines.size() ? ",\n" : "\n");
    return text;
  }

  std::string valid() const {
    const int n = s_.cycles;
    if (n == 0)
      return "  assign valid_o = valid_i;\n  logic unused_clock;\n  assign unused_clock = ^{clk_i, "
             "rst_ni};\n";
    return fmt::format(
        "  logic {0}valid_q;\n  always_ff @(posedge clk_i) begin\n    if (!rst_ni) valid_q <= '0;\n"
        "    else valid_q <= {1};\n  end\n  assign valid_o = {2};\n",
        range_text(n), n == 1 ? "valid_i" : fmt::format("{{valid_q[{}:0], valid_i}}", n - 2),
        n == 1 ? "valid_q" : fmt::format("valid_q[{}]", n - 1));
  }

  std::string outputs_text() {
    std::string text;
    const auto assign = [&](const std::string& to, int k) {
      text += fmt::format("  assign {} = {};\n", to, extended(k, s_.cycles, step(k).bits));
    };
    for (size_t k = 0; k < s_.steps.outputs.size(); ++k)
      assign(outputs_.names[k] + "_o", s_.steps.outputs[k].step);
    if (s_.steps.fault >= 0) {
      assign("fault_valid_o", s_.steps.fault);
      assign("fault_code_o", s_.steps.fault_code);
      assign("fault_number_o", s_.steps.fault_number);
    }
    return text;
  }

  // --- Names and operands ---

  bool is_local(int k) const { return step(k).kind == Kind::slice || step(k).kind == Kind::join; }

  // A step's value as it is in a cycle: "s12", and "s12_3" three registers later; "w13_4" moves bits in
  // cycle 4.
  std::string name_of(int k, int cycle) const {
    if (step(k).kind == Kind::constant) return fmt::format("c{}", k);
    if (is_local(k)) return fmt::format("w{}_{}", k, cycle);
    const int later = std::max(0, cycle - done(k));  // a wrong schedule, unchecked: there is no register
    if (step(k).kind == Kind::input && later == 0) return port_of(k);
    return later == 0 ? fmt::format("s{}", k) : fmt::format("s{}_{}", k, later);
  }

  std::string bit(int k, int cycle, int n) const {
    return step(k).bits == 1 ? name_of(k, cycle) : fmt::format("{}[{}]", name_of(k, cycle), n);
  }
  std::string top(int k, int cycle) const { return bit(k, cycle, step(k).bits - 1); }

  uint64_t number(int k) const {
    const Step& c = step(k);
    const bool negative = c.is_signed && (c.number >> (c.bits - 1) & 1) != 0;
    return negative && c.bits < 64 ? c.number | ~uint64_t{0} << c.bits : c.number;
  }

  // Bits from `low` on, by the step's own sign.
  std::string part(int k, int cycle, int low, int bits) const {
    const Step& of = step(k);
    const int there = std::clamp(of.bits - low, 0, bits), more = bits - there;
    std::string text;
    if (there > 0)
      text = there == of.bits ? name_of(k, cycle)
             : there == 1     ? bit(k, cycle, low)
                              : fmt::format("{}[{}:{}]", name_of(k, cycle), low + there - 1, low);
    if (more == 0) return text;
    const std::string fill = of.is_signed ? top(k, cycle) : "1'b0";
    const std::string above = more == 1 ? fill : fmt::format("{{{}{{{}}}}}", more, fill);
    return there == 0 ? above : fmt::format("{{{}, {}}}", above, text);
  }

  std::string extended(int k, int cycle, int bits) const {
    if (step(k).kind != Kind::constant) return part(k, cycle, 0, bits);
    // 64 bits without a sign are no negative number.
    if (bits > 64 && !step(k).is_signed)
      return fmt::format("{{{{{}{{1'b0}}}}, {}}}", bits - 64, literal(number(k), 64));
    return literal(number(k), bits);
  }

  // --- Steps ---

  void print_steps() {
    for (int k = 0; k < static_cast<int>(s_.steps.steps.size()); ++k) {
      const auto& cycles = layout_.read[static_cast<size_t>(k)];
      if (step(k).kind == Kind::constant) {
        constant(k);
      } else if (is_local(k)) {
        for (const auto& [cycle, bits] : cycles) local(k, cycle, bits);
      } else {
        if (!cycles.empty()) registered(k);
        if (step(k).kind == Kind::input && (cycles.empty() || !is_read(k, 0))) unused_.push_back(port_of(k));
      }
    }
  }

  // Whether all of its bits are read as it is, or by its first register.
  bool is_read(int k, int cycle) const {
    const auto& cycles = layout_.read[static_cast<size_t>(k)];
    if (cycles.rbegin()->first > cycle) return true;
    const auto at = cycles.find(cycle);
    return at != cycles.end() && static_cast<int>(at->second.count()) == step(k).bits;
  }

  // Where a part of a constant is looked at.
  void constant(int k) {
    const auto reads_parts = [&](const Step& of) {
      return (of.kind == Kind::carry || of.kind == Kind::unfit || of.kind == Kind::slice) &&
             std::ranges::find(of.inputs, k) != of.inputs.end();
    };
    if (std::ranges::none_of(s_.steps.steps, reads_parts)) return;
    declared_ += fmt::format("  logic {}c{};\n", range_text(step(k).bits), k);
    assigned_ += fmt::format("  assign c{} = {};\n", k, literal(number(k), step(k).bits));
    unused_.push_back(fmt::format("c{}", k));
  }

  void local(int k, int cycle, const Bits& bits) {
    const Step& of = step(k);
    const std::string name = name_of(k, cycle);
    declared_ += fmt::format("  logic {}{};\n", range_text(of.bits), name);
    const int a = of.inputs[0];
    const std::string text = of.kind == Kind::slice
                                 ? part(a, cycle, of.low, of.bits)
                                 : fmt::format("{{{}, {}}}", extended(a, cycle, step(a).bits),
                                               extended(of.inputs[1], cycle, step(of.inputs[1]).bits));
    assigned_ += fmt::format("  assign {} = {};\n", name, text);
    if (static_cast<int>(bits.count()) < of.bits) unused_.push_back(name);
  }

  void registered(int k) {
    const Step& of = step(k);
    const int first = done(k), last = layout_.last(k);
    if (of.kind != Kind::input) {
      declared_ += fmt::format("  logic {}{};{}\n", range_text(of.bits), name_of(k, first), comment(k));
      computed(k);
    }
    for (int cycle = first + 1; cycle <= last; ++cycle) {
      declared_ += fmt::format("  logic {}{};\n", range_text(of.bits), name_of(k, cycle));
      clocked_ += fmt::format("    {} <= {};\n", name_of(k, cycle), name_of(k, cycle - 1));
      if (!is_read(k, cycle)) unused_.push_back(name_of(k, cycle));
    }
    if (of.kind != Kind::input && !is_read(k, first)) unused_.push_back(name_of(k, first));
  }

  std::string comment(int k) const {
    if (step(k).node < 0 || s_.steps.of_node[static_cast<size_t>(step(k).node)] != k) return {};
    std::string text = label(graph_, step(k).node);
    std::ranges::replace_if(
        text, [](char c) { return c < ' ' || c > '~'; }, '?');
    return "  // " + text;
  }

  void assign(int k, const std::string& text) {
    assigned_ += fmt::format("  assign {} = {};\n", name_of(k, done(k)), text);
  }

  void computed(int k) {
    const Step& of = step(k);
    const int cycle = start_of(s_, k);
    const auto in = [&](size_t n) { return of.inputs[n]; };
    const auto whole = [&](size_t n) { return extended(in(n), cycle, step(in(n)).bits); };
    const auto same = [&](size_t n) { return extended(in(n), cycle, of.bits); };
    switch (of.kind) {
      case Kind::add:
        return of.inputs.size() == 3 ? add_carry(k, cycle) : assign(k, same(0) + " + " + same(1));
      case Kind::sub:
        return assign(k, same(0) + " - " + same(1));
      case Kind::less:
        return compared(k, cycle, "<");
      case Kind::less_equal:
        return compared(k, cycle, "<=");
      case Kind::equal:
        return compared(k, cycle, "==");
      case Kind::both:
        return assign(k, whole(0) + " && " + whole(1));
      case Kind::either:
        return assign(k, whole(0) + " || " + whole(1));
      case Kind::negate:
        return assign(k, "!" + whole(0));
      case Kind::choose:
        return assign(k, fmt::format("{} ? {} : {}", whole(0), same(1), same(2)));
      case Kind::exclusive:
        return assign(k, same(0) + " ^ " + same(1));
      case Kind::leading:
        assigned_ +=
            fmt::format("  cuboct_leading_zeros #(.CountBits({})) u_leading{} (.a_i({}), .zeros_o({}));\n",
                        of.bits, k, whole(0), name_of(k, done(k)));
        return;
      case Kind::shift_left:
        return assign(k, same(0) + " << " + whole(1));
      case Kind::carry:
        return carry(k, cycle);
      case Kind::unfit:
        return unfit(k, cycle);
      case Kind::product:
        return product(k, cycle);
      case Kind::rom:
        tables_.insert(of.table);
        assigned_ += fmt::format("  {} u_rom{} (.clk_i, .index_i({}), .entry_o({}));\n", rom_name(of.table),
                                 k, extended(in(0), cycle, rom_index_bits(of.table)), name_of(k, done(k)));
        return;
      default:
        throw std::logic_error("a pipeline has a step that nothing computes");
    }
  }

  // By an adder of one more bit below: a carry of two ones there is the carry into the sum.
  void add_carry(int k, int cycle) {
    const Step& of = step(k);
    const std::string b = extended(of.inputs[1], cycle, of.bits), c = extended(of.inputs[2], cycle, 1);
    if (step(of.inputs[0]).kind == Kind::constant && step(of.inputs[0]).number == 0)
      return assign(k, b + " + " + extended(of.inputs[2], cycle, of.bits));
    const std::string both = fmt::format("s{}_both", k);
    declared_ += fmt::format("  logic {}{};\n", range_text(of.bits + 1), both);
    assigned_ += fmt::format("  assign {} = {{{}, 1'b1}} + {{{}, {}}};\n", both,
                             extended(of.inputs[0], cycle, of.bits), b, c);
    assign(k, fmt::format("{}[{}:1]", both, of.bits));
    unused_.push_back(both);
  }

  void compared(int k, int cycle, const char* by) {
    const int a = step(k).inputs[0], b = step(k).inputs[1];
    const bool sign = step(a).is_signed || step(b).is_signed;
    const int bits =
        std::max(step(a).bits + (sign && !step(a).is_signed), step(b).bits + (sign && !step(b).is_signed));
    const char* as = sign ? "$signed" : "";
    assign(k,
           fmt::format("{0}({1}) {3} {0}({2})", as, extended(a, cycle, bits), extended(b, cycle, bits), by));
  }

  // Of halves those of negative numbers stay, as they round down in size.
  void carry(int k, int cycle) {
    const int a = step(k).inputs[0], low = step(k).low;
    const std::string half = part(a, cycle, low - 1, 1);
    const int rest = std::min(low - 1, step(a).bits);
    if (rest == 0) return assign(k, fmt::format("{} && !{}", half, top(a, cycle)));
    assign(k, fmt::format("{} && (!{} || ({} != {}))", half, top(a, cycle), part(a, cycle, 0, rest),
                          literal(0, rest)));
  }

  void unfit(int k, int cycle) {
    const int a = step(k).inputs[0], from = step(k).low - 1;
    const int bits = std::max(step(a).bits - from, 1);
    const std::string fill =
        step(a).is_signed ? fmt::format("{{{}{{{}}}}}", bits, top(a, cycle)) : literal(0, bits);
    assign(k, fmt::format("{} != {}", part(a, cycle, from, bits), fill));
  }

  void product(int k, int cycle) {
    const auto signed_bits = [&](int n) { return step(n).bits + !step(n).is_signed; };
    const int a = step(k).inputs[0], b = step(k).inputs[1], bits = signed_bits(a) + signed_bits(b);
    const std::string all = fmt::format("s{}_all", k);
    declared_ += fmt::format("  logic {}{};\n", range_text(bits), all);
    assigned_ += fmt::format(
        "  cuboct_mult #(.ABits({}), .BBits({})) u_mult{} (\n    .clk_i, .rst_ni, .en_i(1'b1), .a_i({}), "
        ".b_i({}), "
        ".p_o({})\n  );\n",
        signed_bits(a), signed_bits(b), k, extended(a, cycle, signed_bits(a)),
        extended(b, cycle, signed_bits(b)), all);
    assign(k, bits == step(k).bits ? all
              : step(k).bits == 1  ? all + "[0]"
                                   : fmt::format("{}[{}:0]", all, step(k).bits - 1));
    if (bits != step(k).bits) unused_.push_back(all);
  }

  // --- Memories ---

  int rom_index_bits(int table) const {
    const auto entries = graph_.tables[static_cast<size_t>(table)].c0.size();
    return std::max(1, static_cast<int>(std::bit_width(entries - 1)));
  }

  std::string rom(int number) const {
    const FixedTable& table = graph_.tables[static_cast<size_t>(number)];
    const EntryForm form = entry_form(table);
    std::string text = fmt::format(
        "// SPDX-License-Identifier: MIT\n// {0} entries of {{{1}c1, c0}}. The entry stands two cycles after "
        "its "
        "index: behind the memory and a register.\n"
        "module {2} (\n  input  logic clk_i,\n  input  logic {3}index_i,\n  output logic {4}entry_o\n);\n"
        "  (* rom_style = \"block\", ram_style = \"block\" *) logic {4}mem [0:{5}];\n"
        "  logic {4}read_q, entry_q;\n"
        "  always_ff @(posedge clk_i) read_q <= mem[index_i];\n"
        "  always_ff @(posedge clk_i) entry_q <= read_q;\n"
        "  assign entry_o = entry_q;\n  initial begin\n",
        table.c0.size(), form.c2 > 0 ? "c2, " : "", rom_name(number), range_text(rom_index_bits(number)),
        range_text(form.bits()), table.c0.size() - 1);
    const auto entry = [](int32_t v, int bits) { return literal(static_cast<uint64_t>(int64_t{v}), bits); };
    for (size_t k = 0; k < table.c0.size(); ++k)
      text += fmt::format("    mem[{}] = {{{}{}, {}}};\n", k,
                          form.c2 > 0 ? entry(table.c2[k], form.c2) + ", " : "", entry(table.c1[k], form.c1),
                          entry(table.c0[k], form.c0));
    return text + "  end\nendmodule\n";
  }

  const std::string& name_;
  const graph::Graph& graph_;
  const Outputs& outputs_;
  const Schedule& s_;
  Layout layout_;
  std::string declared_, assigned_, clocked_;
  std::vector<std::string> unused_;
  std::set<int> tables_;
};

}  // namespace

Outputs pair_pipeline(const graph::Round& round) {
  Outputs all{piped_outputs(round), {}};
  for (size_t s = 0; s < round.sums.size(); ++s)
    for (size_t k = 0; k < round.sums[s].terms.size(); ++k)
      all.names.push_back(fmt::format("sum_{}_{}", s, k));
  for (const graph::Write& write : round.bond_writes)
    all.names.push_back(fmt::format("bond_{}_{}", write.field, write.component));
  all.names.emplace_back("when");
  return all;
}

Outputs finish_pipeline(const graph::FixedProgram& program, const graph::Round& round) {
  Outputs all{graph::finish_outputs(program, round), {}};
  for (const graph::Write& write : round.writes)
    all.names.push_back(fmt::format("field_{}_{}", write.field, write.component));
  if (&round != &program.rounds.back()) return all;
  const auto add = [&](const char* name, const std::vector<int>& nodes) {
    for (size_t a = 0; a < nodes.size(); ++a) all.names.push_back(fmt::format("{}_{}", name, a));
  };
  add("v", program.motion.v), add("u", program.motion.u), add("drift", program.motion.drift);
  return all;
}

std::vector<Module> print_pipeline(const std::string& name, const graph::Graph& graph, const Outputs& outputs,
                                   const Schedule& schedule, const Delays& delays) {
  const std::string wrong = refusal_of(graph, outputs.nodes, schedule, delays);
  if (!wrong.empty()) throw std::logic_error("no pipeline of this schedule: " + wrong);
  const std::set<std::string> names(outputs.names.begin(), outputs.names.end());
  if (names.size() != outputs.nodes.size())
    throw std::logic_error("each output of a pipeline has its own name");
  return print_unchecked(name, graph, outputs, schedule);
}

std::vector<Module> print_unchecked(const std::string& name, const graph::Graph& graph,
                                    const Outputs& outputs, const Schedule& schedule) {
  return Printer(name, graph, outputs, schedule).modules();
}

std::string port_name(const graph::Node& input) {
  return fmt::format("{}_{}_{}_i", to_string(input.source), input.index, input.axis);
}

}  // namespace cuboct::pipeline
