// SPDX-License-Identifier: MIT
#include "tests/rtl/block_lanes.h"

#include <fmt/format.h>

#include <initializer_list>

namespace cuboct::test {
namespace {

std::string given(std::initializer_list<const char*> names) {
  std::string text;
  for (const char* name : names) text += fmt::format(".{0}(cuboct_pkg::{0}), ", name);
  return text;
}

// A port of `bits` bits from a lane, or three, axis 0 in the least significant place.
std::string from(const char* port, int lane, const char* bits, int axes = 1, const char* in = "in_i") {
  std::string text;
  for (int a = axes - 1; a >= 0; --a)
    text += fmt::format("{}[64*{} +: {}]{}", in, lane + a, bits, a > 0 ? ", " : "");
  return fmt::format("    .{}({{{}}}),\n", port, text);
}

// A lane from an expression; assignment extends by the expression's sign.
std::string to(int lane, const std::string& value, bool is_signed = false) {
  return fmt::format(
      "  logic {2}[63:0] lane_{0};\n  assign lane_{0} = {1};\n  assign out_o[64*{0} +: 64] = lane_{0};\n",
      lane, is_signed ? fmt::format("$signed({})", value) : value, is_signed ? "signed " : "");
}

std::string to_axes(int lane, const char* value, const char* bits, bool is_signed = true) {
  std::string text;
  for (int a = 0; a < 3; ++a)
    text += to(lane + a, fmt::format("{}[{}*({}) +: {}]", value, a, bits, bits), is_signed);
  return text;
}

// `law`: what stands before the index in the memory's address.
std::string table(const std::string& prefix, const char* rom, const char* name, const char* value_bits,
                  int lane, const std::string& law) {
  return fmt::format(
             "  logic [cuboct_pkg::{0}IndexBits-1:0] {1}_index;\n"
             "  logic signed [cuboct_pkg::StrengthBits-1:0] {1}_c0, {1}_c1, {1}_c2;\n"
             "  logic signed [cuboct_pkg::{2}-1:0] {1}_value;\n"
             "  cuboct_pair_table #(\n"
             "    .DifferenceFrac(D), .Octaves(cuboct_pkg::{0}Octaves), .Degree(cuboct_pkg::{0}Degree),\n"
             "    .IndexBits(cuboct_pkg::{0}IndexBits), .BinBits(cuboct_pkg::{0}BinBits),\n"
             "    .FirstOctave(cuboct_pkg::{0}FirstOctave), .FractionBits(cuboct_pkg::{0}FractionBits),\n"
             "    .EntryBits(cuboct_pkg::StrengthBits), .ValueBits(cuboct_pkg::{2}),\n"
             "    .OctaveStage(cuboct_pkg::{0}Octaves), .SquareStages(cuboct_pkg::{0}Degree == 2 ? 1 : 0)\n"
             "  ) u_{1} (\n"
             "    .clk_i, .rst_ni, "
             ".valid_i({{(cuboct_pkg::{0}Octaves + (cuboct_pkg::{0}Degree == 2 ? 7 : 5)){{1'b1}}}}),\n"
             "    .r2_i(in_i[64*{4} +: 2*D]), .index_o({1}_index), .c0_i({1}_c0), .c1_i({1}_c1), "
             ".c2_i({1}_c2),\n"
             "    .value_o({1}_value)\n"
             "  );\n"
             "  {3} u_{1}_rom (.clk_i, .index_i({{{5}{1}_index}}), .c0_o({1}_c0), .c1_o({1}_c1), "
             ".c2_o({1}_c2));\n",
             prefix, name, value_bits, rom, static_cast<int>(in::r2), law) +
         to(lane, fmt::format("{}_value", name), true);
}

}  // namespace

std::string print_blocks(const Plan& plan) {
  const bool damped = plan.rule.damped;
  std::string text = fmt::format(
      "// SPDX-License-Identifier: MIT\n"
      "module cuboct_blocks (\n"
      "  input  logic clk_i,\n"
      "  input  logic rst_ni,\n"
      "  input  logic [64*{}-1:0] in_i,\n"
      "  output logic [64*{}-1:0] out_o\n"
      ");\n"
      "  localparam int P = cuboct_pkg::PositionFrac, G = cuboct_pkg::Guard, V = cuboct_pkg::VelocityBits;\n"
      "  localparam int D = P - cuboct_pkg::DifferenceShift;\n"
      "  localparam int T = cuboct_pkg::TypeBits > 0 ? cuboct_pkg::TypeBits : 1;\n"
      "  localparam int SBits = cuboct_pkg::Damped != 0 ? cuboct_pkg::StrengthBits : cuboct_pkg::ForceBits;\n"
      "  localparam int KickFull = SBits + D + 1 - cuboct_pkg::KickShift;\n"
      "  localparam int K = KickFull > 2 ? KickFull : 2;\n"
      "  localparam int Sum = K + $clog2(27 * cuboct_pkg::Capacity);\n"
      "  localparam int U = cuboct_pkg::DisplacementBits, Id = cuboct_pkg::IdBits;\n\n",
      static_cast<int>(in::count), static_cast<int>(out::count));

  // The pipe gets its own particle from a memory, a cycle later.
  text += fmt::format("  logic [64*{}-1:0] in_q;\n  always_ff @(posedge clk_i) in_q <= in_i;\n",
                      static_cast<int>(in::count));
  text += "  logic pipe_valid, pipe_fault, pipe_strength, pipe_busy;\n";
  text += fmt::format("  logic [{}:0] pipe_slot, pipe_slot_next, new_slot;\n", kSlotBits - 1);
  text +=
      "  logic [3*K-1:0] push, kick;\n  logic signed [63:0] pipe_number;\n"
      "  assign kick = {-push[2*K +: K], -push[K +: K], -push[0 +: K]};\n";
  text += "  cuboct_pipe #(\n    " + given({"PositionFrac", "DifferenceShift",
                                            "Cutoff2",      "Contact2",
                                            "IndexBits",    "Octaves",
                                            "Degree",       "BinBits",
                                            "FirstOctave",  "FractionBits",
                                            "ForceBits",    "Damped",
                                            "VelocityBits", "RelativeVelocityBits",
                                            "WShift",       "QShift",
                                            "DampShift",    "StrengthBits",
                                            "Scaled",       "ScaleBits",
                                            "ScaleFrac",    "KickShift",
                                            "LawBits"});
  if (damped)
    text += given({"DampIndexBits", "DampOctaves", "DampDegree", "DampBinBits", "DampFirstOctave",
                   "DampFractionBits", "DampBits"});
  text += fmt::format(
      "\n    .EntryBits(cuboct_pkg::StrengthBits), .TypeBits(T), .KickBits(K), .SlotBits({})\n"
      "  ) u_pipe (\n    .clk_i, .rst_ni,\n",
      kSlotBits);
  text += from("valid_i", in::pipe_valid, "1") +
          from("slot_i", in::pipe_slot, fmt::format("{}", kSlotBits).c_str()) +
          from("own_x_i", in::own_x, "P", 3, "in_q") + from("own_v_i", in::own_v, "V", 3, "in_q") +
          from("own_type_i", in::own_type, "T", 1, "in_q") + from("other_x_i", in::other_x, "(P+2)", 3) +
          from("other_v_i", in::other_v, "V", 3) + from("other_type_i", in::other_type, "T");
  text +=
      "    .valid_o(pipe_valid), .slot_next_o(pipe_slot_next), .slot_o(pipe_slot), .push_o(push), "
      ".fault_o(pipe_fault),\n"
      "    .fault_strength_o(pipe_strength), .fault_number_o(pipe_number), .busy_o(pipe_busy)\n  );\n";
  text += to_axes(out::d, "u_pipe.d_q", "D+1") + to(out::r2, "u_pipe.r2_q") +
          to(out::q, damped ? "u_pipe.gen_damp.q_q" : "1'b0", damped) +
          to(out::force, "u_pipe.force_value", true) + to(out::damped, "u_pipe.s_damped", true) +
          to(out::s, "u_pipe.s", true) + to(out::pipe_valid, "pipe_valid") + to(out::pipe_slot, "pipe_slot") +
          to_axes(out::kick, "kick", "K") + to(out::pipe_fault, "pipe_fault") +
          to(out::pipe_strength, "pipe_strength") + to(out::pipe_number, "pipe_number", true) +
          to(out::pipe_busy, "pipe_busy");

  text +=
      "\n  logic new_valid, fault;\n  logic [3:0] code;\n  logic signed [63:0] number;\n"
      "  logic [3*P-1:0] new_x;\n  logic [3*G-1:0] new_residue;\n  logic [5:0] away;\n  logic [3*V-1:0] "
      "new_v;\n  logic [T-1:0] new_type;\n"
      "  logic [Id-1:0] new_id, fault_id;\n  logic [3*U-1:0] new_u;\n  cuboct_update #(\n    " +
      given({"PositionFrac", "Guard", "VelocityBits", "SumBits", "Weighted", "Pd", "DisplacementBits",
             "GainBits", "GainFrac", "ConstantBits", "IdBits"}) +
      fmt::format(
          "\n    .TotalBits(Sum), .TypeBits(T), .SlotBits({})\n  ) u_update (\n    .clk_i, .rst_ni, "
          ".velocity_i(1'b0),\n",
          kSlotBits);
  text += from("valid_i", in::update_valid, "1") +
          from("slot_i", in::update_slot, fmt::format("{}", kSlotBits).c_str()) +
          from("sum_i", in::sum, "Sum", 3) + from("x_i", in::x, "P", 3) +
          from("residue_i", in::residue, "G", 3) + from("v_i", in::v, "V", 3) +
          from("type_i", in::type, "T") + from("id_i", in::id, "Id") + from("u_i", in::u, "U", 3);
  text +=
      "    .valid_o(new_valid), .slot_o(new_slot), .x_o(new_x), .residue_o(new_residue), .away_o(away), "
      ".v_o(new_v), "
      ".type_o(new_type),\n"
      "    .id_o(new_id), .u_o(new_u), .fault_o(fault), .fault_code_o(code),\n"
      "    .fault_id_o(fault_id), .fault_number_o(number)\n  );\n";
  text += to(out::update_valid, "new_valid") + to(out::update_slot, "new_slot") +
          to_axes(out::x, "new_x", "P", false) + to_axes(out::residue, "new_residue", "G", false) +
          to_axes(out::away, "away", "2") + to_axes(out::v, "new_v", "V") + to(out::type, "new_type") +
          to(out::id, "new_id") + to_axes(out::u, "new_u", "U") + to(out::fault, "fault") +
          to(out::fault_id, "fault_id") + to(out::code, "code") + to(out::number, "number", true);

  text += "\n";
  const int law_bits = plan.rule.law_bits;
  text += table("", "cuboct_force_rom", "force", "ForceBits", out::force_table,
                law_bits > 0 ? fmt::format("{}'d0, ", law_bits) : "");
  text += damped ? table("Damp", "cuboct_damp_rom", "damp", "DampBits", out::damp_table, "")
                 : to(out::damp_table, "1'b0");
  return text + "endmodule\n";
}

}  // namespace cuboct::test
