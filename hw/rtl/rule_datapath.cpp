// SPDX-License-Identifier: MIT
#include "hw/rtl/rule_datapath.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>

#include "hw/rtl/rule_printer.h"

namespace cuboct {
namespace {

int slot_bits(const Plan& plan) {
  return std::max(1, static_cast<int>(std::bit_width(static_cast<unsigned>(plan.arch.capacity - 1))));
}

}  // namespace

using pipeline::Form;

RulePrinter::RulePrinter(const Plan& plan) : plan_(plan), program_(plan.program->program), words_(plan) {
  for (const graph::Round& round : program_.rounds) {
    pairs_.push_back(pipeline::pair_pipeline(round));
    finishes_.push_back(pipeline::finish_pipeline(program_, round));
    pair_schedules_.push_back(pipeline::schedule_of(round.pair, pairs_.back().nodes));
    finish_schedules_.push_back(pipeline::schedule_of(round.finish, finishes_.back().nodes));
  }
}

std::string RulePrinter::joined(const char* format, const char* between) const {
  std::string text;
  for (int k = 0; k < rounds(); ++k)
    text += (k > 0 ? between : "") + fmt::format(fmt::runtime(format), k + 1, k);
  return text;
}

std::string RulePrinter::candidate() const {
  const int P = plan_.rule.widths.position_frac, seen = words_.id_lsb() + plan_.words.id_bits;
  std::string text = fmt::format(
      "// What of an own particle the others see: its position with sign bits, then what the rounds read of "
      "it. "
      "Wires only.\n"
      "module cuboct_rule_candidate (\n  input  logic {}own_i,  // up to its id\n  output logic "
      "{}candidate_o\n);\n",
      range_text(seen), range_text(words_.candidate_bits()));
  for (int a = 0; a < plan_.rule.axes; ++a)
    text += fmt::format("  assign candidate_o[{} +: {}] = {{2'b00, {}}};\n", a * (P + 2), P + 2,
                        words_.own("own_i", FieldKind::position, a).text());
  for (const WordField& f : words_.others())
    text += fmt::format("  assign candidate_o[{} +: {}] = {};\n", f.lsb, f.bits,
                        words_.own("own_i", f.kind, f.axis, f.number).text());
  return text + "  logic unused_own;\n  assign unused_own = ^own_i;\nendmodule\n";
}

std::string RulePrinter::declared_outputs(const pipeline::Schedule& schedule,
                                          const pipeline::Outputs& outputs, std::string& connections) {
  std::string text;
  for (size_t k = 0; k < outputs.names.size(); ++k) {
    const pipeline::Step& step = schedule.steps.steps[at(schedule.steps.outputs[k].step)];
    text += fmt::format("    logic {}{};\n", range_text(step.bits), outputs.names[k]);
    connections += fmt::format(",\n      .{0}_o({0})", outputs.names[k]);
  }
  if (schedule.steps.fault < 0) return text + "    logic made;\n";
  const auto declare = [&](int step, const char* name) {
    const pipeline::Step& s = schedule.steps.steps[at(step)];
    text += fmt::format("    logic {}{};\n", range_text(s.bits), name);
    connections += fmt::format(",\n      .{0}_o({0})", name);
  };
  declare(schedule.steps.fault, "fault_valid");
  declare(schedule.steps.fault_code, "fault_code");
  declare(schedule.steps.fault_number, "fault_number");
  return text + "    logic made;\n";
}

std::string RulePrinter::fault_of(const pipeline::Schedule& schedule, const FaultNets& nets,
                                  const std::string& valid, int stage) {
  if (schedule.steps.fault < 0)
    return fmt::format("    assign {} = 1'b0;\n    assign {} = '0;\n    assign {} = '0;\n", nets.valid,
                       nets.code, nets.number);
  const Form code = form_of_step(schedule, schedule.steps.fault_code),
             number = form_of_step(schedule, schedule.steps.fault_number);
  number_bits_ = std::max(number_bits_, pipeline::signed_bits(number));
  return fmt::format(
      "    assign {0} = {1} && fault_valid;\n"
      "    assign {2} = {{4'd{3}, {4}}} & {{8 {{{0}}}}};\n"
      "    assign {5} = {{{{(NumberBits - {6}) {{{7}}}}}, fault_number}} & {{NumberBits {{{0}}}}};\n",
      nets.valid, valid, nets.code, stage, Slice{"fault_code", 0, code.bits, false}.fit(4), nets.number,
      number.bits, number.is_signed ? fmt::format("fault_number[{}]", number.bits - 1) : "1'b0");
}

std::string RulePrinter::pair_of(int k) {
  const graph::Round& round = program_.rounds[at(k)];
  const pipeline::Schedule& schedule = pair_schedules_[at(k)];
  const int C = schedule.cycles;
  std::string connections;
  std::string text = fmt::format(
      "\n  // Round {0}: a pair that is issued in cycle t has its inputs in registers in t+2, and comes to "
      "the sums in "
      "t+{1}.\n"
      "  logic [ForcePipes-1:0] busy_{0}, fault_{0};\n"
      "  logic [ForcePipes*SlotBits-1:0] kick_slot_{0};\n"
      "  logic [ForcePipes*8-1:0] code_{0};\n"
      "  logic [ForcePipes*NumberBits-1:0] number_{0};\n",
      k + 1, C + 2);
  for (int s = 0; s < static_cast<int>(round.sums.size()); ++s)
    text += fmt::format("  logic [ForcePipes*{}-1:0] sums_{}_{};\n",
                        sum_bits(k, s) * static_cast<int>(round.sums[at(s)].terms.size()), k + 1, s);
  text += fmt::format(
      "  for (genvar f = 0; f < ForcePipes; f++) begin : gen_pair_{0}\n"
      "    logic {1}own;\n"
      "    logic {2}candidate_q;\n"
      "    logic [{3}:1] age_q;  // a pair that was issued so many cycles ago\n"
      "    logic [SlotBits-1:0] next_slot;\n"
      "    assign own = own_i[f*{4} +: {4}];\n"
      "    always_ff @(posedge clk_i) begin\n"
      "      if (!rst_ni) age_q <= '0;\n"
      "      else age_q <= {{age_q[{5}:1], issue_i[f] && round_i[{6}]}};\n"
      "    end\n"
      "    always_ff @(posedge clk_i) begin\n"
      "      if (issue_i[f] && round_i[{6}]) candidate_q <= candidate_i;\n"
      "    end\n"
      "    cuboct_delay #(.Bits(SlotBits), .Depth({7})) u_slot (\n"
      "      .clk_i, .d_i(issue_slot_i[f*SlotBits +: SlotBits]), .q_o(next_slot)\n"
      "    );\n",
      k + 1, range_text(words_.pair_bits()), range_text(words_.candidate_bits()), C + 2, words_.pair_bits(),
      C + 1, k, C + 1);
  std::string outputs;
  const std::string declared = declared_outputs(schedule, pairs_[at(k)], outputs);
  if (words_.places() > 0) text += declared + met_of(k);
  text += inputs(round.pair, schedule, k, true, connections);
  if (words_.places() == 0) text += declared;
  connections += outputs;
  text += fmt::format(
      "    cuboct_pair_{0} u_pipeline (\n      .clk_i, .rst_ni, .valid_i(age_q[2]){1},\n      "
      ".valid_o(made)\n    );\n"
      "    assign busy_{0}[f] = (age_q != '0);\n"
      "    assign kick_slot_{0}[f*SlotBits +: SlotBits] = next_slot;\n",
      k + 1, connections);
  for (int s = 0; s < static_cast<int>(round.sums.size()); ++s) {
    const int components = static_cast<int>(round.sums[at(s)].terms.size());
    const int kick = kick_bits(k, s), sum = sum_bits(k, s);
    std::vector<std::string> terms;
    for (int c = components - 1; c >= 0; --c) {
      const Form form = form_of_output(schedule, round.place(s) + c);
      terms.push_back(Slice{fmt::format("sum_{}_{}", s, c), 0, form.bits, form.is_signed}.fit(kick));
    }
    // A word of its own: yosys takes no signed signal for an unsigned port.
    text += fmt::format("    logic {}push_{};\n    assign push_{} = {{{}}};\n", range_text(components * kick),
                        s, s, fmt::join(terms, ", "));
    text += fmt::format(
        "    cuboct_sums #(\n      .Axes({0}), .KickBits({1}), .SumBits({2}), .Capacity({3}), .Spaced(0), "
        ".Adds(1),\n"
        "      .SlotBits(SlotBits)\n    ) u_sums_{4} (\n      .clk_i, .rst_ni, .kick_valid_i(made && when),\n"
        "      .push_i(push_{4}),\n      .next_slot_i(busy_{5}[f] ? next_slot : look_slot_i),\n"
        "      .take_i(take_i && round_i[{6}]), .sum_o(sums_{5}_{4}[f*{7} +: {7}])\n    );\n",
        components, kick, sum, plan_.arch.capacity, s, k + 1, k, components * sum);
  }
  text += fault_of(schedule,
                   {fmt::format("fault_{}[f]", k + 1), fmt::format("code_{}[f*8 +: 8]", k + 1),
                    fmt::format("number_{}[f*NumberBits +: NumberBits]", k + 1)},
                   "made && when", 2 * k);
  return text + "    logic unused_words;\n    assign unused_words = ^{own, candidate_q, when};\n  end\n";
}

std::string RulePrinter::finish_of(int k) {
  const graph::Round& round = program_.rounds[at(k)];
  const pipeline::Schedule& schedule = finish_schedules_[at(k)];
  const bool last = k + 1 == rounds();
  const int C = schedule.cycles, P = plan_.rule.widths.position_frac, G = plan_.rule.widths.guard;
  const int own_bits = plan_.words.particle_bits + 2;
  std::string connections;
  std::string text = fmt::format(
      "\n  // The finish of round {0}: a particle that is taken in cycle t has its inputs in registers in "
      "t+2, and is "
      "written\n  // in t+{1}.\n"
      "  logic written_{0}, finish_fault_{0};\n"
      "  logic {2}slot_{0};\n"
      "  logic [SlotBits-1:0] place_{0};\n"
      "  logic [7:0] finish_code_{0};\n"
      "  logic [NumberBits-1:0] finish_number_{0};\n"
      "  logic [Axes-1:0] leaving_{0};\n"
      "  if (1) begin : gen_finish_{0}\n"
      "    logic taken_q, ready_q;\n"
      "    logic {2}slot_q, waited;\n"
      "    always_ff @(posedge clk_i) begin\n"
      "      if (!rst_ni) begin\n"
      "        taken_q <= 1'b0;\n"
      "        ready_q <= 1'b0;\n"
      "      end else begin\n"
      "        taken_q <= take_i && round_i[{3}];\n"
      "        ready_q <= taken_q;\n"
      "      end\n"
      "    end\n"
      "    always_ff @(posedge clk_i) begin\n"
      "      if (take_i && round_i[{3}]) slot_q <= {4};\n"
      "    end\n",
      k + 1, C + 2, range_text(own_bits), k, words_.places() > 0 ? "taken_slot" : "slot_i");
  if (words_.places() > 0) text += lost_of(k);
  for (int s = 0; s < static_cast<int>(round.sums.size()); ++s) {
    const int components = static_cast<int>(round.sums[at(s)].terms.size()), sum = sum_bits(k, s);
    text += fmt::format(
        "    logic {0}all_{1}, total_{1};\n"
        "    always_comb begin\n"
        "      all_{1} = sums_{2}_{1}[{3}:0];\n"
        "      for (int f = 1; f < ForcePipes; f = f + 1)\n"
        "        for (int a = 0; a < {4}; a = a + 1)\n"
        "          all_{1}[a*{5} +: {5}] = all_{1}[a*{5} +: {5}] + sums_{2}_{1}[f*{6}+a*{5} +: {5}];\n"
        "    end\n"
        "    always_ff @(posedge clk_i) begin\n      if (take_i && round_i[{7}]) total_{1} <= all_{1};\n    "
        "end\n",
        range_text(components * sum), s, k + 1, components * sum - 1, components, sum, components * sum, k);
  }
  text += inputs(round.finish, schedule, k, false, connections);
  text += declared_outputs(schedule, finishes_[at(k)], connections);
  text += fmt::format(
      "    cuboct_finish_{0} u_pipeline (\n      .clk_i, .rst_ni, .valid_i(ready_q){1},\n      "
      ".valid_o(made)\n    );\n"
      "    {2} #(.Bits({3}), .Depth({4})) u_waited (.clk_i, {5}.d_i(slot_q), .q_o(waited));\n"
      "    cuboct_delay #(.Bits(SlotBits), .Depth({6})) u_place (.clk_i, .d_i(take_slot_i), "
      ".q_o(place_{0}));\n"
      "    assign written_{0} = made;\n",
      k + 1, connections, C + 1 >= 2 ? "cuboct_ring" : "cuboct_delay", own_bits, C + 1,
      C + 1 >= 2 ? ".rst_ni, " : "", C + 2);
  // The slot: what the finish made in the place of what was there.
  std::vector<Part> made;
  for (size_t w = 0; w < round.writes.size(); ++w) {
    const graph::Write& write = round.writes[w];
    const WordField& f =
        words_.own_field(FieldKind::field, -1, program_.place(write.field) + write.component);
    const Form form = form_of_output(schedule, static_cast<int>(w));
    const Slice value{fmt::format("field_{}_{}", write.field, write.component), 0, form.bits, form.is_signed};
    made.push_back({f.lsb, f.bits, value.fit(f.bits)});
  }
  std::string leaving;
  if (last) {
    int output = static_cast<int>(round.writes.size());
    const auto put = [&](const char* name, FieldKind kind, const std::vector<int>& nodes) {
      for (int a = 0; a < static_cast<int>(nodes.size()); ++a, ++output) {
        const Form form = form_of_output(schedule, output);
        const Slice value{fmt::format("{}_{}", name, a), 0, form.bits, form.is_signed};
        if (kind == FieldKind::position) {
          text +=
              fmt::format("    logic {}moved_{};\n    assign moved_{} = {{2'b00, {}, {}}} + {};\n",
                          range_text(P + G + 2), a, a, words_.own("waited", FieldKind::position, a).text(),
                          words_.own("waited", FieldKind::residue, a).text(), value.fit(P + G + 2));
          const auto moved = [&](int lsb, int bits) {
            return fmt::format("moved_{}[{} +: {}]", a, lsb, bits);
          };
          made.push_back({words_.own_field(FieldKind::position, a).lsb, P, moved(G, P)});
          made.push_back({words_.own_field(FieldKind::residue, a).lsb, G, moved(0, G)});
          made.push_back(
              {a == 0 ? own_bits - 2 : words_.own_field(FieldKind::away, a).lsb, 2, moved(P + G, 2)});
          leaving = fmt::format("{} != 2'b00", moved(P + G, 2)) + (a > 0 ? ", " : "") + leaving;
        } else {
          const WordField& f = words_.own_field(kind, a);
          made.push_back({f.lsb, f.bits, value.fit(f.bits)});
        }
      }
    };
    put("v", FieldKind::velocity, program_.motion.v);
    put("u", FieldKind::displacement, program_.motion.u);
    put("drift", FieldKind::position, program_.motion.drift);
  }
  text += fmt::format("    assign slot_{0} = written_{0} ? {1} : '0;\n", k + 1,
                      with_parts("waited", own_bits, made, ",\n      "));
  text += last ? fmt::format("    assign leaving_{0} = {{{1}}} & {{Axes {{written_{0}}}}};\n", k + 1, leaving)
               : fmt::format("    assign leaving_{} = '0;\n", k + 1);
  text += fault_of(schedule,
                   {fmt::format("finish_fault_{}", k + 1), fmt::format("finish_code_{}", k + 1),
                    fmt::format("finish_number_{}", k + 1)},
                   "made", 2 * k + 1);
  std::string totals;
  for (size_t s = 0; s < round.sums.size(); ++s) totals += fmt::format(", total_{}", s);
  return text +
         fmt::format("    logic unused_waited;\n    assign unused_waited = ^{{waited, slot_q{}}};\n  end\n",
                     totals);
}

std::string RulePrinter::text() {
  const int own_bits = plan_.words.particle_bits + 2, seen = words_.pair_bits();
  std::string rounds_text;
  for (int k = 0; k < rounds(); ++k) {
    if (words_.places() > 0)
      rounds_text += fmt::format(
          "\n  logic [ForcePipes*{1}-1:0] met_{0};\n  logic [ForcePipes*SlotBits-1:0] met_slot_{0};\n"
          "  logic [ForcePipes*{2}-1:0] new_numbers_{0};\n  logic lost_{0};\n  logic {3}lost_id_{0}, "
          "lost_other_{0};\n{4}",
          k + 1, words_.places(), std::max(1, words_.number_bits()), range_text(plan_.words.id_bits),
          words_.number_bits() == 0 ? fmt::format("  assign new_numbers_{} = '0;\n", k + 1) : std::string());
    rounds_text += pair_of(k) + finish_of(k);
  }
  if (words_.places() > 0) number_bits_ = std::max(number_bits_, plan_.words.id_bits + 1);
  number_bits_ = std::max(number_bits_,
                          static_cast<int>(std::bit_width(static_cast<unsigned>(plan_.arch.capacity))) + 1);
  std::string text = fmt::format(
      "// What becomes of particles in a node, by the rule: pairs go through the pipelines of their round, "
      "what they "
      "make is\n// summed by particle, the finish of each round writes the particles, and the least fault of "
      "the step "
      "is kept.\n"
      "module cuboct_rule_datapath (\n"
      "  input  logic clk_i,\n"
      "  input  logic rst_ni,\n"
      "  input  logic [{0}:0] round_i,  // one bit each\n"
      "  input  logic [{1}:0] issue_i,  // by pipe: a pair\n"
      "  input  logic [{2}:0] issue_slot_i,\n"
      "  input  logic {3}candidate_i,  // with issue_i\n"
      "  input  logic [{4}:0] own_i,  // in the cycle after issue_i: the own particle up to its id\n"
      "  output logic [{1}:0] busy_o,  // the pipe holds a pair\n"
      "  output logic [{2}:0] kick_slot_o,  // of the next cycle's sum, which may be a fault\n"
      "  input  logic [{5}:0] kick_id_i,  // the id at kick_slot_o of the cycle before\n"
      "  input  logic [{6}:0] look_slot_i,  // the sums that the next cycle's take_i is about\n"
      "  input  logic take_i,  // a particle is taken, with its sums\n"
      "  input  logic [{6}:0] take_slot_i,\n"
      "  input  logic {7}slot_i,  // with take_i: {{away_x, particle}}\n"
      "  output logic written_o,\n"
      "  output logic [{6}:0] slot_number_o,  // with written_o\n"
      "  output logic {7}slot_o,\n"
      "  output logic [{8}:0] leaving_o,  // with written_o: axes along which it has left its cell\n"
      "  input  logic step_end_i,  // the step's last cycle\n"
      "  input  logic move_fault_i,  // a fault of migration, told a cycle later\n"
      "  input  logic [1:0] move_axis_i,\n"
      "  input  logic move_full_i,  // no slot is free, else there is no link\n"
      "  input  logic {9}move_id_i,\n"
      "  output logic fault_o,  // with step_end_i: there was one\n"
      "  output logic [7:0] fault_code_o,  // {{stage, code}}\n"
      "  output logic {9}fault_id_o,\n"
      "  output logic [63:0] fault_number_o\n"
      ");\n"
      "  localparam int Axes       = {10};\n"
      "  localparam int ForcePipes = {11};\n"
      "  localparam int SlotBits   = {12};\n"
      "  localparam int NumberBits = {13};\n",
      rounds() - 1, plan_.arch.force_pipes - 1, plan_.arch.force_pipes * slot_bits(plan_) - 1,
      range_text(words_.candidate_bits()), plan_.arch.force_pipes * seen - 1,
      plan_.arch.force_pipes * plan_.words.id_bits - 1, slot_bits(plan_) - 1, range_text(own_bits),
      plan_.rule.axes - 1, range_text(plan_.words.id_bits), plan_.rule.axes, plan_.arch.force_pipes,
      slot_bits(plan_), number_bits_);
  if (step_bits_ > 0)
    text += fmt::format(
        "  logic {}step_q;  // since the reset\n"
        "  always_ff @(posedge clk_i) begin\n    if (!rst_ni) step_q <= '0;\n"
        "    else if (step_end_i) step_q <= step_q + 1'b1;\n  end\n",
        range_text(step_bits_));
  text += bonds_text() + rounds_text;
  text += fmt::format(
      "\n  assign busy_o        = {};\n"
      "  assign kick_slot_o   = {};\n"
      "  assign written_o     = {};\n"
      "  assign slot_number_o = {};\n"
      "  assign slot_o        = {};\n"
      "  assign leaving_o     = {};\n",
      joined("busy_{}", " | "),
      joined("(kick_slot_{0} & {{(ForcePipes * SlotBits) {{round_i[{1}]}}}})", " | "),
      joined("written_{}", " || "), joined("(place_{0} & {{SlotBits {{written_{0}}}}})", " | "),
      joined("slot_{}", " | "), joined("leaving_{}", " | "));
  // A bond that was lost speaks beside the pipes, in the round's finish.
  const auto with_lost = [&](const std::string& lost, const std::string& pipes) {
    return words_.places() > 0 ? fmt::format("{{{}, {}}}", lost, pipes) : pipes;
  };
  std::string lost_codes;
  for (int k = 0; k < rounds(); ++k)
    lost_codes += fmt::format("{}({{4'd{}, 4'd{}}} & {{8 {{lost_{}}}}})", k > 0 ? " | " : "", 2 * k,
                              static_cast<int>(Fault::bond_lost), k + 1);
  // The id of a finish's fault is that of the slot.
  text += fmt::format(
      "\n  logic [ForcePipes*64-1:0] pipe_numbers;\n"
      "  logic [ForcePipes*NumberBits-1:0] pipe_number;\n"
      "  logic [NumberBits-1:0] finish_number;\n"
      "  assign pipe_number   = {};\n"
      "  assign finish_number = {};\n"
      "  for (genvar f = 0; f < ForcePipes; f++) begin : gen_number\n"
      "    assign pipe_numbers[f*64 +: 64] = {{{{(65 - NumberBits) "
      "{{pipe_number[f*NumberBits+NumberBits-1]}}}},\n"
      "                                       pipe_number[f*NumberBits +: NumberBits-1]}};\n"
      "  end\n"
      "  logic       move_fault_q, move_full_q;\n"
      "  logic [7:0] move_code_q;\n"
      "  logic {}move_id_q;\n"
      "  always_ff @(posedge clk_i) begin\n"
      "    if (!rst_ni) move_fault_q <= 1'b0;\n"
      "    else move_fault_q <= move_fault_i;\n"
      "  end\n"
      "  always_ff @(posedge clk_i) begin\n"
      "    move_full_q <= move_full_i;\n"
      "    move_code_q <= {{4'd{}, 4'd6 + {{1'b0, move_axis_i, 1'b0}} + {{3'b000, move_full_i}}}};  // left, "
      "full: 6 7, "
      "8 9, 10 11\n"
      "    move_id_q   <= move_id_i;\n"
      "  end\n"
      "  cuboct_least_fault #(\n"
      "    .Sources({}), .IdBits({}), .NumberBits(NumberBits), .CodeBits(8)\n"
      "  ) u_fault (\n"
      "    .clk_i, .rst_ni, .clear_i(step_end_i), .valid_i({}),\n      .code_i({}),\n"
      "    .id_i({}), .number_i({}), .update_valid_i({}),\n"
      "    .update_code_i({}), .update_id_i({}),\n"
      "    .update_number_i({{{{(65 - NumberBits) {{finish_number[NumberBits-1]}}}}, "
      "finish_number[NumberBits-2:0]}}),\n"
      "    .move_valid_i(move_fault_q), .move_code_i(move_code_q), .move_id_i(move_id_q),\n"
      "    .move_number_i(move_full_q ? 64'd{} : 64'd0), .valid_o(fault_o), .code_o(fault_code_o), "
      ".id_o(fault_id_o),\n"
      "    .number_o(fault_number_o)\n"
      "  );\n"
      "  logic unused_candidate;\n  assign unused_candidate = ^candidate_i;\nendmodule\n",
      joined("number_{}", " | "), joined("finish_number_{}", " | "), range_text(plan_.words.id_bits),
      2 * rounds(), plan_.arch.force_pipes + (words_.places() > 0 ? 1 : 0), plan_.words.id_bits,
      with_lost(joined("lost_{}", " || "), joined("fault_{}", " | ")),
      with_lost(lost_codes, joined("code_{}", " | ")), with_lost(joined("lost_id_{}", " | "), "kick_id_i"),
      with_lost(fmt::format("{{{} {{1'b0}}}}, {}", 64 - plan_.words.id_bits, joined("lost_other_{}", " | ")),
                "pipe_numbers"),
      joined("finish_fault_{}", " || "), joined("finish_code_{}", " | "),
      words_.own("slot_o", FieldKind::id).text(), plan_.arch.capacity);
  return text;
}

std::vector<pipeline::Module> RulePrinter::pipelines() const {
  std::vector<pipeline::Module> all;
  const auto add = [&](std::vector<pipeline::Module> modules) {
    for (pipeline::Module& module : modules) all.push_back(std::move(module));
  };
  for (int k = 0; k < rounds(); ++k) {
    const graph::Round& round = program_.rounds[at(k)];
    add(print_pipeline(fmt::format("cuboct_pair_{}", k + 1), round.pair, pairs_[at(k)],
                       pair_schedules_[at(k)]));
    add(print_pipeline(fmt::format("cuboct_finish_{}", k + 1), round.finish, finishes_[at(k)],
                       finish_schedules_[at(k)]));
  }
  if (program_.bonded && program_.broken_at >= 0) {
    const std::vector<int> broken{program_.broken_at};
    add(print_pipeline("cuboct_broken", program_.broken, {broken, {"broken"}},
                       pipeline::schedule_of(program_.broken, broken)));
  }
  return all;
}

std::vector<std::pair<std::string, std::string>> rule_parameters(const Plan& plan) {
  const RuleWords words(plan);
  const size_t rounds = plan.rounds.size();
  const auto packed = [&](auto value) {
    std::string text;
    for (size_t k = rounds; k-- > 0;)
      text += (text.empty() ? "" : ", ") + fmt::format("16'd{}", value(plan.rounds[k]));
    return "{" + text + "}";
  };
  int most = 1;
  for (const PlanRound& round : plan.rounds) most = std::max(most, bits_of(round.record));
  std::vector<std::pair<std::string, std::string>> all{
      {"IdLsb", std::to_string(words.id_lsb())},
      {"Rounds", std::to_string(rounds)},
      {"RecordBits", packed([](const PlanRound& r) { return bits_of(r.record); })},
      {"FinishCycles", packed([](const PlanRound& r) { return r.finish; })},
      {"MostBits", std::to_string(most)},
      {"LaterBits", std::to_string(words.later_bits())}};
  if (words.places() > 0) {
    all.emplace_back("Bonds", std::to_string(words.places()));
    all.emplace_back("BondLsb", std::to_string(words.bond_lsb()));
    all.emplace_back("BondBits", std::to_string(words.place_bits()));
    all.emplace_back("IdInCandidate", std::to_string(words.id_in_candidate()));
  }
  if (!graph::moves(plan.program->program)) all.emplace_back("Moves", "0");
  return all;
}

std::vector<pipeline::Module> rule_modules(const Plan& plan) {
  RulePrinter printer(plan);
  std::vector<pipeline::Module> all{{"cuboct_rule_candidate", printer.candidate()},
                                    {"cuboct_rule_datapath", printer.text()}};
  for (pipeline::Module& module : printer.pipelines()) all.push_back(std::move(module));
  return all;
}

}  // namespace cuboct
