// SPDX-License-Identifier: MIT
#include "synth/delays.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

namespace cuboct::synth {
namespace {

using Which = Link::Which;

// LFE5U, speed grade 6. Cells: Project Trellis' database, timing/speed_6/cells.json
// (github.com/YosysHQ/prjtrellis-db), the largest of its three numbers, as nextpnr-ecp5 takes them: SLOGICB,
// SCCU2C, SDPRAME, DP16KD in NORMAL write mode without output register. A PFUMX's data inputs: A0 to OFX0
// less A0 to F0. As nextpnr-ecp5 0.8 reported them on the paths of ecp5_hops.tsv: MULT18X18D without
// registers, L6MUX21's data, a LUT memory's written bit on its way into its LUT, a LUT into its register.
//
// Wires: the least squares of ecp5_hops.tsv. A chain is entered through a cell more, and placed as one
// column: its first carry lies `kChainEntry` farther than a LUT would. `kShare`: the least hundredth at which
// no node of ecp5_placed.tsv is estimated more than 3 % too fast. tests/synth/calibration_test.cpp finds all
// of them again.
constexpr double kShare = 0.94, kChainEntry = 0.982;
const Delays kEcp5Speed6 = {
    "LFE5U, speed 6",
    {
        {"LUT4", {{"A|B|C|D", "Z", 0.236}}, {}, {}},
        {"PFUMX", {{"ALUT|BLUT", "Z", 0.165}, {"C0", "Z", 0.256}}, {}, {}},
        {"L6MUX21", {{"D0|D1", "Z", 0.239}, {"SD", "Z", 0.252}}, {}, {}},
        {"CCU2C",
         {{"A0|B0|C0|D0", "S0", 0.236},
          {"A1|B1|C1|D1", "S1", 0.236},
          {"A0|B0|C0|D0", "S1", 0.714},
          {"A#|B#|C#|D#", "COUT", 0.447},
          {"CIN", "S0", 0.443},
          {"CIN", "S1", 0.474},
          {"CIN", "COUT", 0.071}},
         {},
         {}},
        {"TRELLIS_FF",
         {},
         {{"CLK", "Q", 0.525}},
         {{"DI|M", "CLK", 0}, {"CE", "CLK", 0}, {"LSR", "CLK", 0.424}}},
        {"TRELLIS_DPR16X4",
         {{"RAD*", "DO*", 0.236}},
         {{"WCK", "DO*", 0.929}},
         {{"DI*|WAD*", "WCK", 0.080}, {"WRE", "WCK", 0.392}}},
        {"DP16KD|PDPW16KD",
         {},
         {{"CLKA", "DOA#", 5.609}, {"CLKB", "DOB#", 5.830}},
         {{"ADA#", "CLKA", 0.251},
          {"ADB#", "CLKB", 0.205},
          {"DIA#", "CLKA", 0.218},
          {"DIB#", "CLKB", 0.218},
          {"CEA", "CLKA", 0.211},
          {"CEB", "CLKB", 0.211},
          {"WEA", "CLKA", 0.139},
          {"WEB", "CLKB", 0.139},
          {"RSTA", "CLKA", 0.579},
          {"RSTB", "CLKB", 0.585}}},
        {"MULT18X18D", {{"A#|B#", "P#", 3.927}}, {}, {}},
    },
    "TRELLIS_IO|EHXPLLL|DCCA|GSR|SGSR|BB|IB|OB",
    {0.789,
     0.349,
     0.531,
     1.587,
     kShare,
     8,
     "DP16KD|PDPW16KD|MULT18X18D",
     "MULT18X18D",  // no wire into a block RAM was on a critical path
     "TRELLIS_FF|TRELLIS_DPR16X4",
     "DI*|M|RAD*|WAD*",
     {
         {"CCU2C", "COUT", "CCU2C", "CIN", 0},
         // Through a carry cell more, as the chain alone reaches these pins.
         {"CCU2C", "COUT", "*", "*", 0.443, true},
         {"*", "*", "CCU2C", "CIN", 0.447 + kShare* kChainEntry, true},
         {"LUT4", "Z", "PFUMX", "ALUT|BLUT", 0},
         {"PFUMX", "Z", "L6MUX21", "D0|D1", 0},
         {"L6MUX21", "Z", "L6MUX21", "D0|D1", 0},
         // Into the register of the same slice.
         {"LUT4|PFUMX|L6MUX21|CCU2C|TRELLIS_DPR16X4", "*", "TRELLIS_FF", "DI", 0.130, false, Which::one},
     }},
    0.07,
};

// iCE40: icestorm's timings_hx8k.txt and timings_up5k.txt, the largest of their three numbers. A multiplier's
// and a block RAM's pins: the slowest.
CellDelays lut(double i0, double i1, double i2, double i3) {
  return {"SB_LUT4", {{"I0", "O", i0}, {"I1", "O", i1}, {"I2", "O", i2}, {"I3", "O", i3}}, {}, {}};
}
CellDelays carry(double ci, double i0, double i1) {
  return {"SB_CARRY", {{"CI", "CO", ci}, {"I0", "CO", i0}, {"I1", "CO", i1}}, {}, {}};
}
// D: a register with a LUT before it in its cell has its setup behind the LUT's delay.
CellDelays flip_flop(double q, double reset) {
  return {"SB_DFF*", {}, {{"C", "Q", q}}, {{"D", "C", 0}, {"E", "C", 0}, {"R|S", "C", reset}}};
}
CellDelays ram(double read, double address, double data, double enable) {
  return {"SB_RAM40_4K*",
          {},
          {{"RCLK*", "RDATA*", read}},
          {{"RADDR*", "RCLK*", address},
           {"WADDR*", "WCLK*", address},
           {"WDATA*", "WCLK*", data},
           {"MASK*", "WCLK*", data},
           {"RE", "RCLK*", enable},
           {"WE", "WCLK*", enable},
           {"RCLKE", "RCLK*", enable},
           {"WCLKE", "WCLK*", enable}}};
}
// `chain`: of a carry into the next cell, a fifth of a nanosecond or more after each eight; `next`: into the
// LUT behind it; `through`: a LUT that only passes on; `lone`: the setup of a register without a LUT.
std::vector<Link> ice40_links(double chain, double next, double through, double enter, double lone) {
  return {
      {"SB_CARRY", "CO", "SB_CARRY", "CI", chain},
      {"SB_CARRY", "CO", "SB_LUT4", "I3", next},
      {"SB_CARRY", "CO", "*", "*", next + through, true},
      {"*", "*", "SB_CARRY", "CI", enter, true},
      {"SB_LUT4", "O", "SB_DFF*", "D", 0, false, Which::alone},
      {"*", "*", "SB_DFF*", "D", lone, true},
  };
}

constexpr double kAnySinks = 1e9;
constexpr const char* kIce40Untimed = "SB_IO|SB_GB*|SB_HFOSC|SB_PLL40*|SB_RGBA_DRV";

const Delays kHx8k = {
    "iCE40HX8K",
    {lut(0.449, 0.400, 0.379, 0.316), carry(0.126, 0.259, 0.231), flip_flop(0.540, 0.203),
     ram(2.146, 0.224, 0.274, 0.267)},
    kIce40Untimed,
    {0.60, 0.10, 0.10, 0, 1, kAnySinks, "", "", "", "", ice40_links(0.025, 0.260, 0.316, 0.259, 0.470)},
    0.3,
};
const Delays kUp5k = {
    "iCE40UP5K",
    {lut(1.285, 1.232, 1.205, 0.874),
     carry(0.278, 0.675, 0.609),
     flip_flop(1.391, 0.530),
     ram(1.179, 0.424, 0.517, 0.503),
     {"SB_MAC16",
      {},
      {{"CLK", "O_#", 2.009}},
      {{"A_#|B_#", "CLK", 9.050}, {"OHOLD*", "CLK", 0.415}},
      "TOPOUTPUT_SELECT",
      "01"},  // registers behind the product
     {"SB_MAC16", {{"A_#|B_#", "O_#", 9.050}}, {}, {}}},
    kIce40Untimed,
    {1.76, 0.30, 0.30, 0, 1, kAnySinks, "", "", "", "", ice40_links(0.070, 0.662, 0.874, 0.675, 1.232)},
    0.2,
};

bool matches_one(std::string_view pattern, std::string_view text) {
  if (pattern.empty()) return text.empty();
  if (pattern[0] == '*' || pattern[0] == '#') {
    const bool digits = pattern[0] == '#';
    for (size_t n = digits ? 1 : 0; n <= text.size(); ++n) {
      if (digits && !std::isdigit(static_cast<unsigned char>(text[n - 1]))) return false;
      if (matches_one(pattern.substr(1), text.substr(n))) return true;
    }
    return false;
  }
  return !text.empty() && pattern[0] == text[0] && matches_one(pattern.substr(1), text.substr(1));
}

}  // namespace

const Delays* delays_of(const Target& target) {
  if (target.family == Family::ecp5) return &kEcp5Speed6;
  if (target.name == "hx8k") return &kHx8k;
  if (target.name == "up5k") return &kUp5k;
  return nullptr;
}

bool matches(const char* pattern, const std::string& text) {
  std::string_view rest = pattern;
  while (true) {
    const size_t bar = rest.find('|');
    if (matches_one(rest.substr(0, bar), text)) return true;
    if (bar == std::string_view::npos) return false;
    rest.remove_prefix(bar + 1);
  }
}

double wire_delay(const Wires& wires, const std::string& from_cell, const std::string& from_pin,
                  const std::string& to_cell, const std::string& to_pin, size_t sinks, bool& taken) {
  const bool spread = matches(wires.spread_cells, to_cell) && matches(wires.spread_pins, to_pin);
  const double doublings = std::log2(std::min(static_cast<double>(sinks), wires.most_sinks));
  const double common = wires.share * (wires.near + (spread ? wires.spread : wires.doubling) * doublings +
                                       (matches(wires.far_from, from_cell) ? wires.far : 0) +
                                       (matches(wires.far_to, to_cell) ? wires.far : 0));
  for (const Link& l : wires.links) {
    if (!matches(l.from_cell, from_cell) || !matches(l.from_pin, from_pin) || !matches(l.to_cell, to_cell) ||
        !matches(l.to_pin, to_pin))
      continue;
    if (l.which == Which::alone && sinks > 1) continue;
    if (l.which == Which::one) {
      if (taken) continue;
      taken = true;
    }
    return l.ns + (l.wire ? common : 0);
  }
  return common;
}

}  // namespace cuboct::synth
