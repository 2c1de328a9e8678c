// SPDX-License-Identifier: MIT
#include "synth/script.h"

#include <fmt/format.h>

#include "model/base/text.h"
#include "synth/elaborate.h"

namespace cuboct::synth {
namespace {

std::string read_all(const std::vector<std::string>& files, const std::string& top) {
  std::string text;
  for (const std::string& f : files) text += fmt::format("read_verilog -sv {}\n", yosys_file(f));
  return text + fmt::format("hierarchy -check -top {}\n", top);
}

std::string synth_command(const Target& target) {
  switch (target.family) {
    case Family::ice40:
      return target.holds[Resource::dsp] > 0 ? "synth_ice40 -dsp" : "synth_ice40";
    case Family::ecp5:
      return "synth_ecp5";
    case Family::xc7:
      return "synth_xilinx -family xc7 -flatten";
    case Family::asic:
      break;
  }
  return "";
}

// The longest path between registers, in cells: all that can be said of speed before placing. Cells whose
// outputs come from registers go; a LUT memory stays as what it is on its read side, LUTs, or each write
// would be a path.
std::string depth_commands(Family family, const std::string& out) {
  const std::string flat = "setattr -mod -unset keep_hierarchy *\nflatten\n", end = "ltp\n";
  switch (family) {
    case Family::ecp5:
      return flat +
             fmt::format("delete t:TRELLIS_FF t:DP16KD t:PDPW16KD\ntechmap -map {}\n",
                         yosys_file(out + "/read_side.v")) +
             end;
    case Family::xc7:
      return flat + "delete t:FD?E t:RAM* t:SRL* t:DSP48E1\n" + end;
    case Family::ice40:  // nextpnr says more
    case Family::asic:
      break;
  }
  return "";
}

}  // namespace

std::string elaborate_script(const std::vector<std::string>& files, const std::string& top,
                             const std::string& out) {
  return read_all(files, top) + fmt::format("proc\nwrite_json {}\n", yosys_file(out + "/elaborated.json"));
}

std::string fpga_script(const Synthesis& s, const Target& target) {
  std::string text = read_all(s.files, s.top);
  if (s.module != s.unit) text += fmt::format("rename {} {}\n", s.module, s.unit);
  if (s.harness)
    text += fmt::format("read_verilog {}\nsetattr -mod -set keep_hierarchy 1 {}\n",
                        yosys_file(s.out + "/harness.v"), s.unit);
  if (!s.kept.empty()) text += fmt::format("setattr -mod -set keep_hierarchy 1 {}\n", s.kept);
  text += fmt::format("{} -top {}\n{}write_json {}\n", synth_command(target), s.harness ? kHarness : s.unit,
                      s.counts_only ? "" : "autoname\n", yosys_file(s.out + "/netlist.json"));
  if (s.counts_only) return text;
  text += fmt::format("write_verilog -noattr {}\n", yosys_file(s.out + "/netlist.v"));
  text += depth_commands(target.family, s.out);
  return text;
}

std::string asic_script(const Synthesis& s, const std::string& liberty) {
  std::string text = read_all(s.files, s.top);
  if (s.module != s.unit) text += fmt::format("rename {} {}\n", s.module, s.unit);
  // Multipliers stay apart until they are gates. A clock of 1 ps: as fast as can be.
  return text + fmt::format(
                    "synth -flatten -top {0}\n"
                    "dfflibmap -liberty {1}\n"
                    "abc -liberty {1} -constr {2} -D 1\n"
                    "setattr -mod -unset keep_hierarchy *\n"
                    "flatten\n"
                    "splitnets\n"
                    "opt_clean -purge\n"
                    "autoname\n"
                    "write_json {3}\n"
                    "write_verilog -noattr {4}\n",
                    s.unit, yosys_file(liberty), yosys_file(s.out + "/abc.constr"),
                    yosys_file(s.out + "/netlist.json"), yosys_file(s.out + "/netlist.v"));
}

std::string sta_script(const std::string& liberty, const std::string& netlist, const std::string& top,
                       double period, double activity) {
  return fmt::format(
      "read_liberty {0}\n"
      "set_cmd_units -time ns -power W\n"
      "read_verilog {1}\n"
      "link_design {2}\n"
      "create_clock -name clk -period {3:.4f} [get_ports clk_i]\n"
      "report_checks -path_delay max\n"
      "set_power_activity -global -activity {4:g}\n"
      "report_power\n",
      tcl_word(liberty), tcl_word(netlist), tcl_word(top), period, activity);
}

std::string read_side_module() {
  std::string luts;
  for (int b = 0; b < 4; ++b)
    luts += fmt::format("  LUT4 u_{0} (.A(RAD[0]), .B(RAD[1]), .C(RAD[2]), .D(RAD[3]), .Z(DO[{0}]));\n", b);
  return "module TRELLIS_DPR16X4 #(\n  parameter WCKMUX = \"WCK\", parameter WREMUX = \"WRE\", parameter "
         "INITVAL = 0\n) (\n  input [3:0] DI, WAD, RAD, input WRE, WCK, output [3:0] DO\n);\n" +
         luts + "endmodule\n";
}

std::string place_script(const Target& target, const std::string& top, double frequency, int seed,
                         const std::string& pins) {
  return fmt::format(
      "#!/bin/sh\n"
      "# Places and routes netlist.json: run it in this directory, where nextpnr-ecp5 and ecppack are in "
      "PATH.\n"
      "# Then, in the project's directory: cuboct synth . --target {0} --unit UNIT --timing timing.json\n"
      "set -eu\n"
      "nextpnr-ecp5 --{1} --package {2} --speed 6 --json netlist.json --top {3} --freq {4:g} --seed {5} \\\n"
      "  --timing-allow-fail {6}--textcfg unit.config --report timing.json --log nextpnr.log\n"
      "ecppack --compress unit.config unit.bit\n",
      target.name, target.name == "ecp5-25" ? "25k" : "85k", target.package, shell_word(top), frequency, seed,
      pins.empty() ? "--lpf-allow-unconstrained " : "--lpf pins.lpf ");
}

}  // namespace cuboct::synth
