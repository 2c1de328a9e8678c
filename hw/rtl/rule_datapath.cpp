// SPDX-License-Identifier: MIT
#include "hw/rtl/rule_datapath.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <map>
#include <set>

#include "hw/rtl/rtl_template.h"
#include "model/base/integer_math.h"
#include "model/program/integer_program.h"

namespace cuboct {
namespace {

using graph::FixedProgram;
using graph::Node;
using graph::Op;
using graph::Source;
using pipeline::Form;

size_t at(int k) { return static_cast<size_t>(k); }

// Bits of a word that stands in a vector of the text.
struct Slice {
  std::string of;
  int lsb = 0, bits = 0;
  bool is_signed = false;

  std::string text() const { return fmt::format("{}[{} +: {}]", of, lsb, bits); }
  // Extended or cut to `width`.
  std::string fit(int width) const {
    if (bits >= width) return fmt::format("{}[{} +: {}]", of, lsb, width);
    const std::string sign = is_signed ? fmt::format("{}[{}]", of, lsb + bits - 1) : "1'b0";
    return fmt::format("{{{{{} {{{}}}}}, {}}}", width - bits, sign, text());
  }
};

std::string range_text(int bits) { return fmt::format("[{}:0] ", bits - 1); }

int slot_bits(const Plan& plan) {
  return std::max(1, static_cast<int>(std::bit_width(static_cast<unsigned>(plan.arch.capacity - 1))));
}

// Bits of two's complement that hold a value of this form.
int signed_bits(const Form& form) { return form.bits + (form.is_signed ? 0 : 1); }

class Datapath {
 public:
  explicit Datapath(const Plan& plan) : plan_(plan), program_(plan.program->program) {
    const int P = plan.rule.widths.position_frac;
    candidate_pos_ = plan.rule.axes * (P + 2);
    int positions = 0;
    for (const WordField& f : plan.words.halo)
      if (f.kind == FieldKind::position) positions += f.bits;
    rest_ = plan.words.halo_bits - positions;
    int lsb = candidate_pos_;
    for (const PlanRound& round : plan.rounds) {
      for (WordField f : round.record) {
        if (f.kind == FieldKind::position) continue;
        f.lsb = lsb, lsb += f.bits;
        others_.push_back(f);
      }
    }
    candidate_bits_ = lsb;
    places_ = plan.words.bonds;
    for (const WordField& f : plan.words.particle) {
      if (f.place == 0 && f.kind == FieldKind::bond_other) bond_lsb_ = f.lsb;
      if (f.place == 0) place_bits_ = f.lsb + f.bits - bond_lsb_;
      if (f.place == 0 && f.kind == FieldKind::bond_kind) kind_bits_ = f.bits;
    }
    for (const graph::Round& round : program_.rounds) {
      pairs_.push_back(pipeline::pair_pipeline(round));
      finishes_.push_back(pipeline::finish_pipeline(program_, round));
      pair_schedules_.push_back(pipeline::schedule_of(round.pair, pairs_.back().nodes));
      finish_schedules_.push_back(pipeline::schedule_of(round.finish, finishes_.back().nodes));
    }
  }

  std::string candidate() const;
  std::string text();
  std::vector<pipeline::Module> pipelines() const;
  int later_bits() const { return candidate_bits_ - candidate_pos_ - rest_; }
  int places() const { return places_; }
  int bond_lsb() const { return bond_lsb_; }
  int place_bits() const { return place_bits_; }
  int id_in_candidate() const { return other("", FieldKind::id).lsb; }
  // Bits of an own particle that a pair reads.
  int pair_bits() const { return places_ > 0 ? plan_.words.particle_bits : id_lsb() + plan_.words.id_bits; }
  int id_lsb() const { return own_field(FieldKind::id).lsb; }

 private:
  int rounds() const { return static_cast<int>(program_.rounds.size()); }
  const WordField& own_field(FieldKind kind, int axis = -1, int number = 0) const {
    return *std::ranges::find_if(plan_.words.particle, [&](const WordField& f) {
      return f.kind == kind && f.axis == axis && (kind != FieldKind::field || f.number == number);
    });
  }
  Slice own(const std::string& of, FieldKind kind, int axis = -1, int number = 0) const {
    const WordField& f = own_field(kind, axis, number);
    return {of, f.lsb, f.bits, f.is_signed};
  }
  Slice other(const std::string& of, FieldKind kind, int axis = -1) const {
    const auto f =
        std::ranges::find_if(others_, [&](const WordField& g) { return g.kind == kind && g.axis == axis; });
    return {of, f->lsb, f->bits, f->is_signed};
  }
  // What a round has of a field: as the last round sent it that did so.
  Slice other_number(const std::string& of, int number, int round) const;
  std::string types_of(const std::string& own_word, const std::string& other_word, const Node& node, int bits,
                       const std::string& name, std::string& text) const;
  // Of the first place of a row.
  const WordField& bond_field(int number) const {
    return *std::ranges::find_if(plan_.words.particle, [&](const WordField& f) {
      return f.kind == FieldKind::bond_field && f.place == 0 && f.number == number;
    });
  }
  // Where numbers that rounds write begin in a place, and their bits.
  int numbers_lsb() const { return plan_.words.id_bits + kind_bits_; }
  int place_numbers() const { return place_bits_ - numbers_lsb(); }
  std::string kind_of(const Node& node, int bits, const std::string& name, std::string& text) const;
  std::string met_of(int round) const;
  std::string bonds_text() const;
  std::string lost_of(int round);
  std::string input(const Node& node, int round, bool pair, int bits, std::string& text);
  std::string inputs(const graph::Graph& graph, const pipeline::Schedule& schedule, int round, bool pair,
                     std::string& connections);
  std::string pair_of(int round);
  std::string finish_of(int round);
  Form form_of_output(const pipeline::Schedule& schedule, int output) const {
    const pipeline::Step& step = schedule.steps.steps[at(schedule.steps.outputs[at(output)].step)];
    return {step.bits, step.is_signed};
  }
  Form form_of_step(const pipeline::Schedule& schedule, int step) const {
    const pipeline::Step& s = schedule.steps.steps[at(step)];
    return {s.bits, s.is_signed};
  }
  int sum_bits(int round, int sum) const;
  int kick_bits(int round, int sum) const;

  const Plan& plan_;
  const FixedProgram& program_;
  int candidate_pos_ = 0, rest_ = 0, candidate_bits_ = 0;
  std::vector<WordField> others_;  // of a candidate, behind its positions
  std::vector<pipeline::Outputs> pairs_, finishes_;
  std::vector<pipeline::Schedule> pair_schedules_, finish_schedules_;
  int step_bits_ = 0;                                  // of the step's number; 0: nobody reads it
  int places_ = 0;                                     // of a row of bonds
  int bond_lsb_ = 0, place_bits_ = 0, kind_bits_ = 0;  // of the row, of a place, of a kind's number
  int number_bits_ = 0;                                // of any number that a fault tells
};

Slice Datapath::other_number(const std::string& of, int number, int round) const {
  int lsb = candidate_pos_;
  Slice found;
  for (int k = 0; k <= round; ++k)
    for (const WordField& f : plan_.rounds[at(k)].record) {
      if (f.kind == FieldKind::position) continue;
      if (f.kind == FieldKind::field && f.number == number) found = {of, lsb, f.bits, f.is_signed};
      lsb += f.bits;
    }
  return found;
}

std::string Datapath::candidate() const {
  const int P = plan_.rule.widths.position_frac, seen = id_lsb() + plan_.words.id_bits;
  std::string text = fmt::format(
      "// What of an own particle the others see: its position with sign bits, then what the rounds read of "
      "it. "
      "Wires only.\n"
      "module cuboct_rule_candidate (\n  input  logic {}own_i,  // up to its id\n  output logic "
      "{}candidate_o\n);\n",
      range_text(seen), range_text(candidate_bits_));
  for (int a = 0; a < plan_.rule.axes; ++a)
    text += fmt::format("  assign candidate_o[{} +: {}] = {{2'b00, {}}};\n", a * (P + 2), P + 2,
                        own("own_i", FieldKind::position, a).text());
  for (const WordField& f : others_)
    text += fmt::format("  assign candidate_o[{} +: {}] = {};\n", f.lsb, f.bits,
                        own("own_i", f.kind, f.axis, f.number).text());
  return text + "  logic unused_own;\n  assign unused_own = ^own_i;\nendmodule\n";
}

int Datapath::kick_bits(int round, int sum) const {
  const graph::Round& r = program_.rounds[at(round)];
  int bits = 1;
  for (size_t c = 0; c < r.sums[at(sum)].terms.size(); ++c)
    bits = std::max(
        bits, signed_bits(form_of_output(pair_schedules_[at(round)], r.place(sum) + static_cast<int>(c))));
  return bits;
}

int Datapath::sum_bits(int round, int sum) const {
  const graph::Round& r = program_.rounds[at(round)];
  int bits = kick_bits(round, sum);
  for (const int term : r.sums[at(sum)].terms)
    bits = std::max(
        bits, signed_bits(pipeline::form_of(graph::summed(r.pair.nodes[at(term)].range, program_.partners))));
  return bits;
}

// A constant by type, or by both types: a choice that `text` declares.
std::string Datapath::types_of(const std::string& own_word, const std::string& other_word, const Node& node,
                               int bits, const std::string& name, std::string& text) const {
  const bool pair = node.source == Source::pair_constant;
  const auto& constants = pair ? program_.pair_constants : program_.type_constants;
  const std::vector<int64_t>& values = constants[at(node.index)].values;
  if (program_.types == 1) return literal(values[0], bits);
  const bool of_other = node.source == Source::other_constant;
  const int type_bits = plan_.rule.type_bits;
  const std::string own_type = of_other ? "" : own(own_word, FieldKind::type).text();
  const std::string other_type = pair || of_other ? other(other_word, FieldKind::type).text() : "";
  text +=
      fmt::format("    logic {}{};\n    always_comb begin\n      unique case ({})\n", range_text(bits), name,
                  pair       ? fmt::format("{{{}, {}}}", own_type, other_type)
                  : of_other ? other_type
                             : own_type);
  for (int k = 0; k < static_cast<int>(values.size()); ++k) {
    const int key = pair ? (k / program_.types) << type_bits | k % program_.types : k;
    text += fmt::format("        {}: {} = {};\n", literal(key, pair ? 2 * type_bits : type_bits), name,
                        literal(values[at(k)], bits));
  }
  text += fmt::format("        default: {} = '0;\n      endcase\n    end\n", name);
  return name;
}

// A constant of a bond, by the kind that stands lowest in `bond`.
std::string Datapath::kind_of(const Node& node, int bits, const std::string& name, std::string& text) const {
  const graph::BondRows& rows = *plan_.program->rows;
  const size_t constants = program_.bond_constants.size();
  const auto value = [&](uint32_t kind) {
    return literal(rows.constants[kind * constants + at(node.index)], bits);
  };
  if (rows.kinds() == 1) return value(0);
  text += fmt::format("    logic {}{};\n    always_comb begin\n      unique case (bond[{}:0])\n",
                      range_text(bits), name, kind_bits_ - 1);
  for (uint32_t kind = 0; kind < rows.kinds(); ++kind)
    text += fmt::format("        {}: {} = {};\n", literal(kind, kind_bits_), name, value(kind));
  text += fmt::format("        default: {} = '0;\n      endcase\n    end\n", name);
  return name;
}

// In a pair's pipe: which place of the row has the candidate, its kind and numbers; and what becomes of
// these.
std::string Datapath::met_of(int k) const {
  const int B = places_, id = plan_.words.id_bits, rest = place_bits_ - id, numbers = place_numbers();
  const int C = pair_schedules_[at(k)].cycles;
  std::string text = fmt::format(
      "    logic [{0}:0] met, met_late;  // by place: it has the candidate\n"
      "    logic [SlotBits-1:0] slot_q;\n"
      "    for (genvar p = 0; p < {1}; p++) begin : gen_met\n"
      "      assign met[p] = (own[{2}+p*{3} +: {4}] == candidate_q[{5} +: {4}]);\n"
      "    end\n"
      "    cuboct_delay #(.Bits({1}), .Depth({6})) u_met (.clk_i, .d_i(met), .q_o(met_late));\n"
      "    always_ff @(posedge clk_i) slot_q <= next_slot;\n"
      "    assign met_{7}[f*{1} +: {1}] = met_late & {{{1} {{age_q[{8}]}}}};\n"
      "    assign met_slot_{7}[f*SlotBits +: SlotBits] = slot_q;\n",
      B - 1, B, bond_lsb_, place_bits_, id, id_in_candidate(), C + 1, k + 1, C + 2);
  if (rest > 0)
    text += fmt::format(
        "    logic [{0}:0] bond;  // of that place: its kind, its numbers\n"
        "    always_comb begin\n"
        "      bond = '0;\n"
        "      for (int p = 0; p < {1}; p = p + 1) bond = bond | (own[{2}+p*{3} +: {4}] & {{{4} "
        "{{met[p]}}}});\n"
        "    end\n",
        rest - 1, B, bond_lsb_ + id, place_bits_, rest);
  if (numbers == 0) return text;
  text += fmt::format(
      "    logic [{}:0] old_numbers;\n"
      "    cuboct_delay #(.Bits({}), .Depth({})) u_old (.clk_i, .d_i(bond[{} +: {}]), .q_o(old_numbers));\n",
      numbers - 1, numbers, C + 1, kind_bits_, numbers);
  // Written numbers in the place of the old ones.
  const graph::Round& round = program_.rounds[at(k)];
  std::map<int, std::pair<int, std::string>> made;
  for (size_t w = 0; w < round.bond_writes.size(); ++w) {
    const graph::Write& write = round.bond_writes[w];
    const WordField& f = bond_field(program_.bond_place(write.field) + write.component);
    const Form form = form_of_output(pair_schedules_[at(k)], round.numbers() + static_cast<int>(w));
    made[f.lsb - bond_lsb_ - numbers_lsb()] = {
        f.bits,
        Slice{fmt::format("bond_{}_{}", write.field, write.component), 0, form.bits, form.is_signed}.fit(
            f.bits)};
  }
  std::vector<std::string> parts;
  int end = numbers;
  for (auto part = made.rbegin(); part != made.rend(); ++part) {
    const int above = part->first + part->second.first;
    if (above < end) parts.push_back(fmt::format("old_numbers[{}:{}]", end - 1, above));
    parts.push_back(part->second.second);
    end = part->first;
  }
  if (end > 0) parts.push_back(fmt::format("old_numbers[{}:0]", end - 1));
  return text + fmt::format("    assign new_numbers_{}[f*{} +: {}] = {{{}}};\n", k + 1, numbers, numbers,
                            fmt::join(parts, ", "));
}

// What the rounds meet and write of bonds, until the particle is taken.
std::string Datapath::bonds_text() const {
  if (places_ == 0) return "";
  const int B = places_, numbers = place_numbers();
  std::string text = fmt::format(
      "\n  // By slot and place: the bond has met its partner in this round; then the numbers that the pair "
      "left of it.\n"
      "  logic [{0}:0] bond_met_q [0:{1}];\n  logic [{2}:0] bond_numbers_q [0:{1}];\n"
      "  logic [ForcePipes*{3}-1:0] met;\n  logic [ForcePipes*SlotBits-1:0] met_slot;\n"
      "  logic [ForcePipes*{4}-1:0] new_numbers;\n",
      B - 1, plan_.arch.capacity - 1, B * std::max(1, numbers) - 1, B, std::max(1, numbers));
  std::string met, slot, made;
  for (int k = 1; k <= rounds(); ++k) {
    const char* or_text = k > 1 ? " | " : "";
    met += fmt::format("{}met_{}", or_text, k);
    slot += fmt::format("{}(met_slot_{} & {{(ForcePipes * SlotBits) {{round_i[{}]}}}})", or_text, k, k - 1);
    made += fmt::format("{}(new_numbers_{} & {{(ForcePipes * {}) {{round_i[{}]}}}})", or_text, k,
                        std::max(1, numbers), k - 1);
  }
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
        B, bond_lsb_ + numbers_lsb(), place_bits_, numbers);
  return text + "  end\n  logic unused_numbers;\n  assign unused_numbers = ^{taken_numbers, new_numbers};\n";
}

// In a finish: the bonds of the taken particle that count and were not met.
std::string Datapath::lost_of(int k) {
  const int B = places_, id = plan_.words.id_bits, rest = place_bits_ - id;
  int cycles = 0;
  std::string text = fmt::format(
      "    logic [{0}:0] met_q, missed, lost;\n"
      "    always_ff @(posedge clk_i) begin\n      if (take_i) met_q <= taken_met;\n    end\n"
      "    logic [{1}:0] late_slot;\n"
      "    for (genvar p = 0; p < {2}; p++) begin : gen_place\n"
      "      logic still;  // of a taken particle: the bond counts\n"
      "      assign missed[p] = !met_q[p] && (slot_q[{3}+p*{4} +: {5}] != {6});\n",
      B - 1, plan_.words.particle_bits + 1, B, bond_lsb_, place_bits_, id,
      own("slot_q", FieldKind::id).text());
  if (program_.broken_at >= 0) {
    const pipeline::Schedule schedule = pipeline::schedule_of(program_.broken, {program_.broken_at});
    cycles = schedule.cycles;
    std::string connections, before;
    if (rest > 0)
      text += fmt::format("      logic [{}:0] bond;\n      assign bond = slot_q[{}+p*{} +: {}];\n", rest - 1,
                          bond_lsb_ + id, place_bits_, rest);
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
      cycles, plan_.words.particle_bits + 2, id - 1, B - 1, bond_lsb_, place_bits_, id, k + 1,
      own("late_slot", FieldKind::id).text());
  return text;
}

// What an input of a graph is in the cycle before its register; `text` may declare what it needs.
std::string Datapath::input(const Node& node, int round, bool pair, int bits, std::string& text) {
  const std::string word = pair ? "own" : "slot_q";
  const int axis = node.axis;
  const std::string name = pipeline::port_name(node).substr(0, pipeline::port_name(node).size() - 2);
  const int P = plan_.rule.widths.position_frac, G = plan_.rule.widths.guard;
  switch (node.source) {
    case Source::apart: {
      const Slice mine = own(word, FieldKind::position, axis);
      const Slice theirs{"candidate_q", axis * (P + 2), P + 2, true};
      const int width = std::min(P + 3, bits);  // the input holds every difference: its low bits are enough
      text += fmt::format("    logic {}{};\n    assign {} = {} - {};\n", range_text(width), name, name,
                          theirs.fit(width), mine.fit(width));
      return Slice{name, 0, width, true}.fit(bits);
    }
    case Source::own_x: {
      text += fmt::format("    logic {}{};\n    assign {} = {{{}, {}}};\n", range_text(P + G), name, name,
                          own(word, FieldKind::position, axis).text(),
                          own(word, FieldKind::residue, axis).text());
      return Slice{name, 0, P + G, false}.fit(bits);
    }
    case Source::own_v:
      return own(word, FieldKind::velocity, axis).fit(bits);
    case Source::other_v:
      return other("candidate_q", FieldKind::velocity, axis).fit(bits);
    case Source::own_u:
      return own(word, FieldKind::displacement, axis).fit(bits);
    case Source::own_field:
      return own(word, FieldKind::field, -1, program_.place(node.index) + axis).fit(bits);
    case Source::other_field:
      return other_number("candidate_q", program_.place(node.index) + axis, round).fit(bits);
    case Source::own_id:
      return own(word, FieldKind::id).fit(bits);
    case Source::other_id:
      return other("candidate_q", FieldKind::id).fit(bits);
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
      return types_of(word, "candidate_q", node, bits, name, text);
    case Source::bond_field: {
      const WordField& f = bond_field(program_.bond_place(node.index) + axis);
      return Slice{"bond", f.lsb - bond_lsb_ - plan_.words.id_bits, f.bits, f.is_signed}.fit(bits);
    }
    case Source::bond_constant:
      return kind_of(node, bits, name, text);
  }
  throw std::logic_error("RTL has no such input");
}

// Registers of the inputs, and what connects them.
std::string Datapath::inputs(const graph::Graph& graph, const pipeline::Schedule& schedule, int round,
                             bool pair, std::string& connections) {
  std::string before, declared, set;
  for (const pipeline::Port& port : schedule.steps.inputs) {
    const Node& node = graph.nodes[at(port.node)];
    const Form form = form_of_step(schedule, port.step);
    const std::string name = pipeline::port_name(node), value = input(node, round, pair, form.bits, before);
    const std::string reg = "in_" + name.substr(0, name.size() - 2) + "_q";
    declared += fmt::format("    logic {}{};\n", range_text(form.bits), reg);
    set += fmt::format("      {} <= {};\n", reg, value);
    connections += fmt::format(",\n      .{}({})", name, reg);
  }
  if (set.empty()) return before;
  return before + declared + "    always_ff @(posedge clk_i) begin\n" + set + "    end\n";
}

// What the pipelines' outputs connect to: `name_o` to `name`. None is declared signed, as a signed vector
// whose bits are all picked is what yosys 0.23 fails at.
std::string declared_outputs(const pipeline::Schedule& schedule, const pipeline::Outputs& outputs,
                             std::string& connections) {
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

std::string Datapath::pair_of(int k) {
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
      "      if (issue_i[f]) candidate_q <= candidate_i;\n"
      "    end\n"
      "    cuboct_delay #(.Bits(SlotBits), .Depth({7})) u_slot (\n"
      "      .clk_i, .d_i(issue_slot_i[f*SlotBits +: SlotBits]), .q_o(next_slot)\n"
      "    );\n",
      k + 1, range_text(pair_bits()), range_text(candidate_bits_), C + 2, pair_bits(), C + 1, k, C + 1);
  std::string outputs;
  const std::string declared = declared_outputs(schedule, pairs_[at(k)], outputs);
  if (places_ > 0) text += declared + met_of(k);
  text += inputs(round.pair, schedule, k, true, connections);
  if (places_ == 0) text += declared;
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
  if (schedule.steps.fault >= 0) {
    const Form code = form_of_step(schedule, schedule.steps.fault_code),
               number = form_of_step(schedule, schedule.steps.fault_number);
    number_bits_ = std::max(number_bits_, signed_bits(number));
    text += fmt::format(
        "    assign fault_{0}[f] = made && when && fault_valid;\n"
        "    assign code_{0}[f*8 +: 8] = {{4'd{1}, {2}}} & {{8 {{fault_{0}[f]}}}};\n"
        "    assign number_{0}[f*NumberBits +: NumberBits] = {{{{(NumberBits - {3}) {{{4}}}}}, "
        "fault_number}}\n"
        "                                                  & {{NumberBits {{fault_{0}[f]}}}};\n",
        k + 1, 2 * k, Slice{"fault_code", 0, code.bits, false}.fit(4), number.bits,
        number.is_signed ? fmt::format("fault_number[{}]", number.bits - 1) : "1'b0");
  } else {
    text += fmt::format(
        "    assign fault_{0}[f] = 1'b0;\n    assign code_{0}[f*8 +: 8] = '0;\n"
        "    assign number_{0}[f*NumberBits +: NumberBits] = '0;\n",
        k + 1);
  }
  return text + "    logic unused_words;\n    assign unused_words = ^{own, candidate_q, when};\n  end\n";
}

std::string Datapath::finish_of(int k) {
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
      "      if (take_i) slot_q <= {4};\n"
      "    end\n",
      k + 1, C + 2, range_text(own_bits), k, places_ > 0 ? "taken_slot" : "slot_i");
  if (places_ > 0) text += lost_of(k);
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
        "    always_ff @(posedge clk_i) total_{1} <= all_{1};\n",
        range_text(components * sum), s, k + 1, components * sum - 1, components, sum, components * sum);
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
  std::map<int, std::pair<int, std::string>> made;  // lsb: bits and text
  for (size_t w = 0; w < round.writes.size(); ++w) {
    const graph::Write& write = round.writes[w];
    const WordField& f = own_field(FieldKind::field, -1, program_.place(write.field) + write.component);
    const Form form = form_of_output(schedule, static_cast<int>(w));
    made[f.lsb] = {
        f.bits,
        Slice{fmt::format("field_{}_{}", write.field, write.component), 0, form.bits, form.is_signed}.fit(
            f.bits)};
  }
  std::string leaving;
  if (last) {
    int output = static_cast<int>(round.writes.size());
    const auto put = [&](const char* name, FieldKind kind, const std::vector<int>& nodes) {
      for (int a = 0; a < static_cast<int>(nodes.size()); ++a, ++output) {
        const Form form = form_of_output(schedule, output);
        const Slice value{fmt::format("{}_{}", name, a), 0, form.bits, form.is_signed};
        if (kind == FieldKind::position) {
          text += fmt::format("    logic {}moved_{};\n    assign moved_{} = {{2'b00, {}, {}}} + {};\n",
                              range_text(P + G + 2), a, a, own("waited", FieldKind::position, a).text(),
                              own("waited", FieldKind::residue, a).text(), value.fit(P + G + 2));
          const auto moved = [&](int lsb, int bits) {
            return fmt::format("moved_{}[{} +: {}]", a, lsb, bits);
          };
          made[own_field(FieldKind::position, a).lsb] = {P, moved(G, P)};
          made[own_field(FieldKind::residue, a).lsb] = {G, moved(0, G)};
          made[a == 0 ? own_bits - 2 : own_field(FieldKind::away, a).lsb] = {2, moved(P + G, 2)};
          leaving = fmt::format("{} != 2'b00", moved(P + G, 2)) + (a > 0 ? ", " : "") + leaving;
        } else {
          const WordField& f = own_field(kind, a);
          made[f.lsb] = {f.bits, value.fit(f.bits)};
        }
      }
    };
    put("v", FieldKind::velocity, program_.motion.v);
    put("u", FieldKind::displacement, program_.motion.u);
    put("drift", FieldKind::position, program_.motion.drift);
  }
  text += fmt::format("    assign slot_{} = written_{} ? {{", k + 1, k + 1);
  std::vector<std::string> parts;
  int end = own_bits;
  for (auto part = made.rbegin(); part != made.rend(); ++part) {
    const int above = part->first + part->second.first;
    if (above < end) parts.push_back(fmt::format("waited[{}:{}]", end - 1, above));
    parts.push_back(part->second.second);
    end = part->first;
  }
  if (end > 0) parts.push_back(fmt::format("waited[{}:0]", end - 1));
  text += fmt::format("{}}} : '0;\n", fmt::join(parts, ",\n      "));
  text += last ? fmt::format("    assign leaving_{0} = {{{1}}} & {{Axes {{written_{0}}}}};\n", k + 1, leaving)
               : fmt::format("    assign leaving_{} = '0;\n", k + 1);
  if (schedule.steps.fault >= 0) {
    const Form code = form_of_step(schedule, schedule.steps.fault_code),
               number = form_of_step(schedule, schedule.steps.fault_number);
    number_bits_ = std::max(number_bits_, signed_bits(number));
    text += fmt::format(
        "    assign finish_fault_{0} = made && fault_valid;\n"
        "    assign finish_code_{0} = {{4'd{1}, {2}}} & {{8 {{finish_fault_{0}}}}};\n"
        "    assign finish_number_{0} = {{{{(NumberBits - {3}) {{{4}}}}}, fault_number}} & {{NumberBits "
        "{{finish_fault_{0}}}}};\n",
        k + 1, 2 * k + 1, Slice{"fault_code", 0, code.bits, false}.fit(4), number.bits,
        number.is_signed ? fmt::format("fault_number[{}]", number.bits - 1) : "1'b0");
  } else {
    text += fmt::format(
        "    assign finish_fault_{0} = 1'b0;\n    assign finish_code_{0} = '0;\n    assign finish_number_{0} "
        "= '0;\n",
        k + 1);
  }
  std::string totals;
  for (size_t s = 0; s < round.sums.size(); ++s) totals += fmt::format(", total_{}", s);
  return text +
         fmt::format("    logic unused_waited;\n    assign unused_waited = ^{{waited, slot_q{}}};\n  end\n",
                     totals);
}

std::string Datapath::text() {
  const int own_bits = plan_.words.particle_bits + 2, seen = pair_bits();
  std::string rounds_text;
  for (int k = 0; k < rounds(); ++k) {
    if (places_ > 0)
      rounds_text += fmt::format(
          "\n  logic [ForcePipes*{1}-1:0] met_{0};\n  logic [ForcePipes*SlotBits-1:0] met_slot_{0};\n"
          "  logic [ForcePipes*{2}-1:0] new_numbers_{0};\n  logic lost_{0};\n  logic {3}lost_id_{0}, "
          "lost_other_{0};\n{4}",
          k + 1, places_, std::max(1, place_numbers()), range_text(plan_.words.id_bits),
          place_numbers() == 0 ? fmt::format("  assign new_numbers_{} = '0;\n", k + 1) : std::string());
    rounds_text += pair_of(k) + finish_of(k);
  }
  if (places_ > 0) number_bits_ = std::max(number_bits_, plan_.words.id_bits + 1);
  number_bits_ = std::max(number_bits_,
                          static_cast<int>(std::bit_width(static_cast<unsigned>(plan_.arch.capacity))) + 1);
  const auto joined = [&](const char* format, const char* between) {
    std::vector<std::string> parts;
    for (int k = 1; k <= rounds(); ++k) parts.push_back(fmt::format(fmt::runtime(format), k));
    return fmt::format("{}", fmt::join(parts, between));
  };
  std::string slots;
  for (int k = 0; k < rounds(); ++k)
    slots += fmt::format("{}(kick_slot_{} & {{(ForcePipes * SlotBits) {{round_i[{}]}}}})", k > 0 ? " | " : "",
                         k + 1, k);
  std::string places;
  for (int k = 0; k < rounds(); ++k)
    places += fmt::format("{}(place_{} & {{SlotBits {{written_{}}}}})", k > 0 ? " | " : "", k + 1, k + 1);
  std::string leaving;
  for (int k = 0; k < rounds(); ++k) leaving += fmt::format("{}leaving_{}", k > 0 ? " | " : "", k + 1);
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
      range_text(candidate_bits_), plan_.arch.force_pipes * seen - 1,
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
      joined("busy_{}", " | "), slots, joined("written_{}", " || "), places, joined("slot_{}", " | "),
      leaving);
  // A bond that was lost speaks beside the pipes, in the round's finish.
  const auto with_lost = [&](const std::string& lost, const std::string& pipes) {
    return places_ > 0 ? fmt::format("{{{}, {}}}", lost, pipes) : pipes;
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
      2 * rounds(), plan_.arch.force_pipes + (places_ > 0 ? 1 : 0), plan_.words.id_bits,
      with_lost(joined("lost_{}", " || "), joined("fault_{}", " | ")),
      with_lost(lost_codes, joined("code_{}", " | ")), with_lost(joined("lost_id_{}", " | "), "kick_id_i"),
      with_lost(fmt::format("{{{} {{1'b0}}}}, {}", 64 - plan_.words.id_bits, joined("lost_other_{}", " | ")),
                "pipe_numbers"),
      joined("finish_fault_{}", " || "), joined("finish_code_{}", " | "), own("slot_o", FieldKind::id).text(),
      plan_.arch.capacity);
  return text;
}

std::vector<pipeline::Module> Datapath::pipelines() const {
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

}  // namespace

std::vector<std::pair<std::string, std::string>> rule_parameters(const Plan& plan) {
  const Datapath datapath(plan);
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
      {"IdLsb", std::to_string(datapath.id_lsb())},
      {"Rounds", std::to_string(rounds)},
      {"RecordBits", packed([](const PlanRound& r) { return bits_of(r.record); })},
      {"FinishCycles", packed([](const PlanRound& r) { return r.finish; })},
      {"MostBits", std::to_string(most)},
      {"LaterBits", std::to_string(datapath.later_bits())}};
  if (datapath.places() > 0) {
    all.emplace_back("Bonds", std::to_string(datapath.places()));
    all.emplace_back("BondLsb", std::to_string(datapath.bond_lsb()));
    all.emplace_back("BondBits", std::to_string(datapath.place_bits()));
    all.emplace_back("IdInCandidate", std::to_string(datapath.id_in_candidate()));
  }
  return all;
}

std::vector<pipeline::Module> rule_modules(const Plan& plan) {
  Datapath datapath(plan);
  std::vector<pipeline::Module> all{{"cuboct_rule_candidate", datapath.candidate()},
                                    {"cuboct_rule_datapath", datapath.text()}};
  for (pipeline::Module& module : datapath.pipelines()) all.push_back(std::move(module));
  return all;
}

}  // namespace cuboct
