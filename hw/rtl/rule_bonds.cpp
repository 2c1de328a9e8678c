// SPDX-License-Identifier: MIT
// Rows of bonds in a rule's datapath: which place meets the candidate, what pairs leave of its numbers, and
// which bonds that count were not met.
#include <fmt/format.h>

#include <algorithm>

#include "hw/rtl/rule_printer.h"

namespace cuboct {

using graph::Node;
using pipeline::Form;

// In a pair's pipe: which place of the row has the candidate, its kind and numbers; and what becomes of
// these.
std::string RulePrinter::met_of(int k) const {
  const int B = words_.places(), id = plan_.words.id_bits, rest = words_.place_bits() - id,
            numbers = words_.number_bits();
  const int C = pair_schedules_[at(k)].cycles;
  std::string text = fmt::format(
      "    logic [{0}:0] meets, meets_late;  // by place: it has the candidate\n"
      "    logic [SlotBits-1:0] slot_q;\n"
      "    for (genvar p = 0; p < {1}; p++) begin : gen_met\n"
      "      assign meets[p] = (own[{2}+p*{3} +: {4}] == candidate_q[{5} +: {4}]);\n"
      "    end\n"
      "    cuboct_delay #(.Bits({1}), .Depth({6})) u_meets (.clk_i, .d_i(meets), .q_o(meets_late));\n"
      "    always_ff @(posedge clk_i) slot_q <= next_slot;\n"
      "    assign met_{7}[f*{1} +: {1}] = meets_late & {{{1} {{age_q[{8}]}}}};\n"
      "    assign met_slot_{7}[f*SlotBits +: SlotBits] = slot_q;\n",
      B - 1, B, words_.bond_lsb(), words_.place_bits(), id, words_.id_in_candidate(), C + 1, k + 1, C + 2);
  if (rest > 0)
    text += fmt::format(
        "    logic [{0}:0] bond;  // of that place: its kind, its numbers\n"
        "    always_comb begin\n"
        "      bond = '0;\n"
        "      for (int p = 0; p < {1}; p = p + 1) bond = bond | (own[{2}+p*{3} +: {4}] & {{{4} "
        "{{meets[p]}}}});\n"
        "    end\n",
        rest - 1, B, words_.bond_lsb() + id, words_.place_bits(), rest);
  if (numbers == 0) return text;
  text += fmt::format(
      "    logic [{}:0] old_numbers;\n"
      "    cuboct_delay #(.Bits({}), .Depth({})) u_old (.clk_i, .d_i(bond[{} +: {}]), .q_o(old_numbers));\n"
      "    logic unused_old;\n    assign unused_old = ^old_numbers;\n",
      numbers - 1, numbers, C + 1, words_.kind_bits(), numbers);
  // Written numbers in the place of the old ones.
  const graph::Round& round = program_.rounds[at(k)];
  std::vector<Part> made;
  for (size_t w = 0; w < round.bond_writes.size(); ++w) {
    const graph::Write& write = round.bond_writes[w];
    const WordField& f = words_.bond_field(program_.bond_place(write.field) + write.component);
    const Form form = form_of_output(pair_schedules_[at(k)], round.numbers() + static_cast<int>(w));
    const Slice value{fmt::format("bond_{}_{}", write.field, write.component), 0, form.bits, form.is_signed};
    made.push_back({f.lsb - words_.bond_lsb() - words_.numbers_lsb(), f.bits, value.fit(f.bits)});
  }
  return text + fmt::format("    assign new_numbers_{}[f*{} +: {}] = {};\n", k + 1, numbers, numbers,
                            with_parts("old_numbers", numbers, made, ", "));
}

// What the rounds meet and write of bonds, until the particle is taken.
std::string RulePrinter::bonds_text() const {
  if (words_.places() == 0) return "";
  const int B = words_.places(), numbers = words_.number_bits();
  std::string text = fmt::format(
      "\n  // By slot and place: the bond has met its partner in this round; then the numbers that the pair "
      "left of it.\n"
      "  logic [{0}:0] bond_met_q [0:{1}];\n  logic [{2}:0] bond_numbers_q [0:{1}];\n"
      "  logic [ForcePipes*{3}-1:0] met;\n  logic [ForcePipes*SlotBits-1:0] met_slot;\n"
      "  logic [ForcePipes*{4}-1:0] new_numbers;\n",
      B - 1, plan_.arch.capacity - 1, B * std::max(1, numbers) - 1, B, std::max(1, numbers));
  const std::string met = joined("met_{0}", " | "),
                    slot = joined("(met_slot_{0} & {{(ForcePipes * SlotBits) {{round_i[{1}]}}}})", " | "),
                    made = joined(
                        fmt::format("(new_numbers_{{0}} & {{{{(ForcePipes * {}) {{{{round_i[{{1}}]}}}}}}}})",
                                    std::max(1, numbers))
                            .c_str(),
                        " | ");
  text += fmt::format(
      "  assign met         = {};\n  assign met_slot    = {};\n  assign new_numbers = {};\n"
      "  for (genvar s = 0; s < {}; s++) begin : gen_bonds\n"
      "    localparam int Slot = s;\n"
      "    always_ff @(posedge clk_i) begin\n"
      "      if (!rst_ni || (take_i && take_slot_i == Slot[SlotBits-1:0])) bond_met_q[s] <= '0;\n"
      "      else\n"
      "        for (int f = 0; f < ForcePipes; f = f + 1)\n"
      "          if (met_slot[f*SlotBits +: SlotBits] == Slot[SlotBits-1:0])\n"
      "            for (int p = 0; p < {}; p = p + 1)\n"
      "              if (met[f*{}+p]) bond_met_q[s][p] <= 1'b1;\n"
      "    end\n",
      met, slot, made, plan_.arch.capacity, B, B);
  if (numbers > 0)
    text += fmt::format(
        "    always_ff @(posedge clk_i) begin\n"
        "      for (int f = 0; f < ForcePipes; f = f + 1)\n"
        "        if (met_slot[f*SlotBits +: SlotBits] == Slot[SlotBits-1:0])\n"
        "          for (int p = 0; p < {0}; p = p + 1)\n"
        "            if (met[f*{0}+p]) bond_numbers_q[s][p*{1} +: {1}] <= new_numbers[f*{1} +: {1}];\n"
        "    end\n",
        B, numbers);
  else
    text += "    assign bond_numbers_q[s] = '0;\n";
  text += fmt::format(
      "  end\n"
      "  // A particle as it is taken: with the numbers that its bonds have now.\n"
      "  logic [{0}:0] taken_met;\n  logic [{1}:0] taken_numbers;\n  logic [{2}:0] taken_slot;\n"
      "  assign taken_met     = bond_met_q[take_slot_i];\n"
      "  assign taken_numbers = bond_numbers_q[take_slot_i];\n"
      "  always_comb begin\n    taken_slot = slot_i;\n",
      B - 1, B * std::max(1, numbers) - 1, plan_.words.particle_bits + 1);
  if (numbers > 0)
    text += fmt::format(
        "    for (int p = 0; p < {0}; p = p + 1)\n"
        "      if (taken_met[p]) taken_slot[{1}+p*{2} +: {3}] = taken_numbers[p*{3} +: {3}];\n",
        B, words_.bond_lsb() + words_.numbers_lsb(), words_.place_bits(), numbers);
  return text + "  end\n  logic unused_numbers;\n  assign unused_numbers = ^{taken_numbers, new_numbers};\n";
}

// In a finish: the bonds of the taken particle that count and were not met.
std::string RulePrinter::lost_of(int k) {
  const int B = words_.places(), id = plan_.words.id_bits, rest = words_.place_bits() - id;
  int cycles = 0;
  std::string text = fmt::format(
      "    logic [{0}:0] met_q, missed, lost;\n"
      "    always_ff @(posedge clk_i) begin\n      if (take_i) met_q <= taken_met;\n    end\n"
      "    logic [{1}:0] late_slot;\n"
      "    for (genvar p = 0; p < {2}; p++) begin : gen_place\n"
      "      logic still;  // of a taken particle: the bond counts\n"
      "      assign missed[p] = !met_q[p] && (slot_q[{3}+p*{4} +: {5}] != {6});\n",
      B - 1, plan_.words.particle_bits + 1, B, words_.bond_lsb(), words_.place_bits(), id,
      words_.own("slot_q", FieldKind::id).text());
  if (program_.broken_at >= 0) {
    const pipeline::Schedule schedule = pipeline::schedule_of(program_.broken, {program_.broken_at});
    cycles = schedule.cycles;
    std::string connections, before;
    if (rest > 0)
      text += fmt::format(
          "      logic [{}:0] bond;\n      assign bond = slot_q[{}+p*{} +: {}];\n"
          "      logic unused_bond;\n      assign unused_bond = ^bond;\n",
          rest - 1, words_.bond_lsb() + id, words_.place_bits(), rest);
    for (const pipeline::Port& port : schedule.steps.inputs) {
      const Node& node = program_.broken.nodes[at(port.node)];
      const Form form = form_of_step(schedule, port.step);
      const std::string value = input(node, k, true, form.bits, before);
      connections += fmt::format(", .{}({})", pipeline::port_name(node), value);
    }
    text +=
        before + fmt::format(
                     "      logic broken, made_broken;\n"
                     "      cuboct_broken u_broken (.clk_i, .rst_ni, .valid_i(taken_q){}, .broken_o(broken), "
                     ".valid_o(made_broken));\n"
                     "      assign still = made_broken && !broken;\n",
                     connections);
  } else {
    text += "      assign still = taken_q;\n";
  }
  text += fmt::format(
      "      logic missed_late;\n"
      "      cuboct_delay #(.Bits(1), .Depth({0})) u_missed (.clk_i, .d_i(missed[p]), .q_o(missed_late));\n"
      "      assign lost[p] = missed_late && still;\n"
      "    end\n"
      "    cuboct_delay #(.Bits({1}), .Depth({0})) u_late_slot (.clk_i, .d_i(slot_q), .q_o(late_slot));\n"
      "    logic [{2}:0] lost_other;\n"
      "    always_comb begin\n"
      "      lost_other = '0;\n"
      "      for (int p = {3}; p >= 0; p = p - 1) if (lost[p]) lost_other = late_slot[{4}+p*{5} +: {6}];\n"
      "    end\n"
      "    assign lost_{7}       = (lost != '0);\n"
      "    assign lost_id_{7}    = {8} & {{{6} {{lost_{7}}}}};\n"
      "    assign lost_other_{7} = lost_other;\n"
      "    logic unused_late;\n    assign unused_late = ^late_slot;\n",
      cycles, plan_.words.particle_bits + 2, id - 1, B - 1, words_.bond_lsb(), words_.place_bits(), id, k + 1,
      words_.own("late_slot", FieldKind::id).text());
  return text;
}

}  // namespace cuboct
