// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "hw/rtl/rtl_ports.h"
#include "hw/rtl/rtl_template.h"

namespace cuboct {
namespace {

std::string concatenated(const Int3& values, int bits, int axes) {
  std::string text;
  for (int a = axes - 1; a >= 0; --a) text += (text.empty() ? "" : ", ") + literal(values[a], bits);
  return "{" + text + "}";
}

}  // namespace

std::string head(const RtlDesign& design) {
  return "// SPDX-License-Identifier: MIT\n// " + design.maker + "\n";
}

std::string print_package(const RtlDesign& design) {
  std::string text =
      head(design) +
      "// The constants of the plan; docs/reference/node.md says what each is.\npackage cuboct_pkg;\n";
  for (const RtlConstant& c : design.constants) {
    const std::string value = c.wide ? literal(c.value, 64) : std::to_string(c.value);
    const std::string declared =
        fmt::format("  localparam {} {:<20} = {};", c.wide ? "logic [63:0]" : "int         ", c.name, value);
    text += c.comment.empty() ? declared + "\n" : fmt::format("{:<62}  // {}\n", declared, c.comment);
  }
  return text + "endpackage\n";
}

std::string print_table(const RtlDesign& design, const RtlTable& table) {
  const int degree = table.c2.empty() ? 1 : 2;
  const int e = table.entry_bits;
  const int bits = (degree + 1) * e;
  std::string text = head(design);
  text += fmt::format(
      "// {} entries of {{{}c1, c0}}, {} bits each. Synchronous read.\n"
      "module {} (\n"
      "  input  logic                clk_i,\n"
      "  input  logic [{}:0] index_i,\n"
      "  output logic signed [{}:0] c0_o,\n"
      "  output logic signed [{}:0] c1_o,\n"
      "  output logic signed [{}:0] c2_o\n"
      ");\n"
      "  (* rom_style = \"block\", ram_style = \"block\" *) logic [{}:0] mem [0:{}];\n"
      "  logic [{}:0] data_q;\n"
      "  always_ff @(posedge clk_i) data_q <= mem[index_i];\n"
      "  assign c0_o = data_q[{}:0];\n"
      "  assign c1_o = data_q[{}:{}];\n",
      table.c0.size(), degree == 2 ? "c2, " : "", e, table.module, table.index_bits - 1, e - 1, e - 1, e - 1,
      bits - 1, table.c0.size() - 1, bits - 1, e - 1, 2 * e - 1, e);
  text += degree == 2 ? fmt::format("  assign c2_o = data_q[{}:{}];\n", 3 * e - 1, 2 * e)
                      : "  assign c2_o = '0;\n";
  text += "  initial begin\n";
  for (size_t k = 0; k < table.c0.size(); ++k)
    text += fmt::format("    mem[{}] = {{{}{}, {}}};\n", k, degree == 2 ? literal(table.c2[k], e) + ", " : "",
                        literal(table.c1[k], e), literal(table.c0[k], e));
  return text + "  end\nendmodule\n";
}

std::string print_scale(const RtlDesign& design) {
  const int t = std::max(1, design.type_bits);  // one type may still have a scale below 1
  std::string text = head(design);
  text += fmt::format(
      "// What a pair of types multiplies its strength by, ScaleFrac fractional bits, whether the two only "
      "touch,\n"
      "// and the number of their law.\n"
      "// Combinational.\n"
      "module cuboct_scale_rom (\n"
      "  input  logic [{0}:0]         own_type_i,\n"
      "  input  logic [{0}:0]         other_type_i,\n"
      "  output logic signed [17:0] scale_o,\n"
      "  output logic               touch_o,\n"
      "  output logic [{1}:0]         law_o\n"
      ");\n"
      "  always_comb begin\n"
      "    scale_o = '0;\n"
      "    touch_o = 1'b0;\n"
      "    law_o   = '0;\n"
      "    unique case ({{own_type_i, other_type_i}})\n",
      t - 1, std::max(1, design.law_bits) - 1);
  for (size_t i = 0; i < design.scale.size(); ++i)
    for (size_t j = 0; j < design.scale.size(); ++j) {
      const std::string law =
          design.law.empty() ? "1'b0" : fmt::format("{}'d{}", design.law_bits, design.law[i][j]);
      text += fmt::format("      {}: {{law_o, touch_o, scale_o}} = {{{}, 1'b{}, {}}};\n",
                          literal(static_cast<int64_t>(i << t | j), 2 * t), law,
                          design.scale[i][j] < 0 ? 1 : 0, literal(std::abs(design.scale[i][j]), 18));
    }
  return text + "      default: scale_o = '0;\n    endcase\n  end\nendmodule\n";
}

int velocities_bits(const RtlDesign& design) {
  return std::max(1, static_cast<int>(design.moved.size()) * design.axes * design.velocity_bits);
}

std::string print_velocities(const RtlDesign& design) {
  if (design.moved.empty()) return "1'b0";
  std::vector<std::string> velocities;
  for (const int k : design.moved)
    velocities.push_back(
        concatenated(design.types[static_cast<size_t>(k)].velocity, design.velocity_bits, design.axes));
  std::ranges::reverse(velocities);  // the first in the lowest bits
  return fmt::format("{{{}}}", fmt::join(velocities, ", "));
}

std::string print_types(const RtlDesign& design) {
  const int t = std::max(1, design.type_bits), v = design.velocity_bits, axes = design.axes;
  std::string text = head(design);
  text += fmt::format(
      "// What sets the types apart, axis 0 in the least significant place: imposed axes, velocity (imposed, "
      "or of the\n"
      "// anchor), gravity, whether held by force, gains, weight of the sum. Combinational.\n"
      "module cuboct_type_rom (\n"
      "  input  logic [{}:0] velocity_i,  // by type that is moved from outside\n"
      "  input  logic [{}:0] type_i,\n"
      "  output logic [{}:0] imposed_o,\n"
      "  output logic [{}:0] velocity_o,\n"
      "  output logic [{}:0] gravity_o,\n"
      "  output logic pd_o,\n"
      "  output logic [17:0] kp_o,\n"
      "  output logic [17:0] kd_o,\n"
      "  output logic [17:0] weight_o\n"
      ");\n",
      velocities_bits(design) - 1, t - 1, axes - 1, axes * v - 1, axes * v - 1);
  if (design.moved.empty()) text += "  logic unused_velocity;\n  assign unused_velocity = velocity_i;\n";
  const auto velocity = [&](const FixedType& type, int number) {
    const auto at = std::find(design.moved.begin(), design.moved.end(), number);
    if (at == design.moved.end()) return concatenated(type.velocity, v, axes);
    return fmt::format("velocity_i[{} +: {}]", (at - design.moved.begin()) * axes * v, axes * v);
  };
  const auto assigns = [&](const FixedType& type, int number, const std::string& indent) {
    std::string lines;
    std::string imposed;
    for (int a = axes - 1; a >= 0; --a) imposed += type.imposed[a] ? '1' : '0';
    lines += fmt::format("{}imposed_o  = {}'b{};\n", indent, axes, imposed);
    lines += fmt::format("{}velocity_o = {};\n", indent, velocity(type, number));
    lines += fmt::format("{}gravity_o  = {};\n", indent, concatenated(type.gravity, v, axes));
    lines += fmt::format("{}pd_o       = 1'b{};\n", indent, type.pd ? 1 : 0);
    lines += fmt::format("{}kp_o       = {};\n", indent, literal(type.kp, 18));
    lines += fmt::format("{}kd_o       = {};\n", indent, literal(type.kd, 18));
    lines += fmt::format("{}weight_o   = {};\n", indent, literal(type.weight, 18));
    return lines;
  };
  if (design.types.size() == 1)
    return text + "  logic unused_type;\n  assign unused_type = ^type_i;\n" +
           assigns(design.types[0], 0, "  assign ") + "endmodule\n";
  text += "  always_comb begin\n" + assigns(FixedType{}, -1, "    ") + "    unique case (type_i)\n";
  for (size_t k = 0; k < design.types.size(); ++k)
    text += fmt::format("      {}: begin\n{}      end\n", literal(static_cast<int64_t>(k), t),
                        assigns(design.types[k], static_cast<int>(k), "        "));
  return text + "      default: imposed_o = '0;\n    endcase\n  end\nendmodule\n";
}

std::string print_node_box(const RtlDesign& design) {
  const std::vector<RtlPort> ports = node_ports(design, false);
  std::string text = head(design), inputs, outputs;
  for (const RtlPort& p : ports)
    if (p.output)
      outputs += fmt::format("  assign {} = '0;\n", p.name);
    else
      inputs += fmt::format("{}{}", inputs.empty() ? "" : ", ", p.name);
  return text +
         fmt::format(
             "// The ports of cuboct_node and nothing behind them, for the lint of the lattice: the node is "
             "linted once.\n"
             "module cuboct_node (\n{});\n  logic unused_inputs;\n"
             "  assign unused_inputs = ^{{{}}};\n{}endmodule\n",
             print_ports(ports), inputs, outputs);
}

std::string print_node(const RtlDesign& design) {
  const char* core_name = design.text       ? "cuboct_rule_core"
                          : design.bricks() ? "cuboct_brick_core"
                                            : "cuboct_node_core";
  std::string text = head(design);
  text += fmt::format(
      "// One node of the plan: {} with the plan's constants{}.\nmodule cuboct_node (\n{});\n", core_name,
      design.checked ? ", and the checks of its links" : "", print_ports(node_ports(design, false)));
  const std::vector<RtlPort> ports = node_ports(design, true);
  // What stands between the core's links and the node's: the core's port `x_o` is the wire `core_x`, `x_i`
  // the wire `wire_x`.
  const auto guarded = [&](const std::string& name) {
    return design.checked && name != "fault_stage_o" &&
           (name.starts_with("link_") || name.starts_with("fault_"));
  };
  const auto inner = [](const std::string& name) {
    return (name.ends_with("_o") ? "core_" : "wire_") + name.substr(0, name.size() - 2);
  };
  std::vector<std::string> core, connected;
  for (const RtlPort& p : ports) {
    if (guarded(p.name)) text += fmt::format("  logic {}{};\n", range_of(p), inner(p.name));
    connected.push_back(guarded(p.name) ? fmt::format("    .{}({})", p.name, inner(p.name))
                                        : fmt::format("    .{}", p.name));
  }
  for (const RtlConstant& c : design.constants)
    if (c.core) core.push_back(fmt::format("    .{0}(cuboct_pkg::{0})", c.name));
  for (const auto& [name, value] : design.rule) core.push_back(fmt::format("    .{}({})", name, value));
  if (!design.text) core.push_back(fmt::format("    .MovedTypes({})", design.moved.size()));
  if (!design.text && design.moved.empty()) connected.emplace_back("    .velocity_i(1'b0)");
  text += fmt::format("  {} #(\n{}\n  ) u_core (\n{}\n  );\n", core_name, fmt::join(core, ",\n"),
                      fmt::join(connected, ",\n"));
  if (design.checked)
    text += fmt::format(
        "  logic unused_core_ready;\n  assign unused_core_ready = ^core_link_ready;\n"
        "  cuboct_link_guard #(\n"
        "    .Faces({}),\n    .LinkBits(cuboct_pkg::LinkBits),\n"
        "    .SequenceBits(cuboct_pkg::LinkSequence),\n    .Window(cuboct_pkg::LinkWindow),\n"
        "    .Patience(cuboct_pkg::LinkPatience),\n    .Retry(cuboct_pkg::LinkRetry),\n"
        "    .CrcBits(cuboct_pkg::LinkCrc),\n    .CrcPolynomial(cuboct_pkg::LinkPolynomial[31:0]),\n"
        "    .CrcStart(cuboct_pkg::LinkStart[31:0]),\n    .AckCrcBits(cuboct_pkg::AckCrc),\n"
        "    .AckPolynomial(cuboct_pkg::AckPolynomial[31:0]),\n    .AckStart(cuboct_pkg::AckStart[31:0]),\n"
        "    .IdBits(cuboct_pkg::IdBits)\n"
        "  ) u_guard (\n"
        "    .clk_i,\n    .rst_ni,\n    .has_link_i,\n"
        "    .node_valid_i(core_link_valid),\n    .node_end_i(core_link_end),\n"
        "    .node_data_i(core_link_data),\n    .node_ready_o(wire_link_ready),\n"
        "    .node_valid_o(wire_link_valid),\n    .node_end_o(wire_link_end),\n"
        "    .node_data_o(wire_link_data),\n    .node_fault_valid_i(core_fault_valid),\n"
        "    .node_fault_code_i(core_fault_code),\n    .node_fault_id_i(core_fault_id),\n"
        "    .node_fault_number_i(core_fault_number),\n"
        "    .link_valid_o,\n    .link_end_o,\n    .link_data_o,\n    .link_ready_i,\n    .link_ack_i,\n"
        "    .link_valid_i,\n    .link_end_i,\n    .link_data_i,\n    .link_ready_o,\n    .link_ack_o,\n"
        "    .link_error_o,\n"
        "    .fault_valid_o,\n    .fault_code_o,\n    .fault_id_o,\n    .fault_number_o\n"
        "  );\n",
        2 * design.axes);
  if (design.checked && design.bricks())
    text +=
        "  // A link's fault is told by the first cell.\n"
        "  assign fault_cell_o = core_fault_valid ? core_fault_cell : '0;\n";
  return text + "endmodule\n";
}

}  // namespace cuboct
