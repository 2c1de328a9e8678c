// SPDX-License-Identifier: MIT
#include "hw/rtl/board.h"

#include <fmt/format.h>

#include <cmath>

#include "model/base/spelling.h"

namespace cuboct {

const std::vector<Board>& boards() {
  static const std::vector<Board> all{
      {"icebreaker", "iCEBreaker (iCE40UP5K)", 12000000, "pins.pcf", "up5k",
       "yosys -q -p 'read_verilog -sv '\"$(tr '\\n' ' ' < board/files.f)\"'; synth_ice40 -dsp -top "
       "cuboct_board_top "
       "-json board/top.json'\n"
       "nextpnr-ice40 --up5k --package sg48 --freq 12 --json board/top.json --pcf board/pins.pcf --asc "
       "board/top.asc\n"
       "icepack board/top.asc board/top.bin\n",
       "iceprog board/top.bin                     # or: openFPGALoader -b ice40_generic board/top.bin\n"},
      {"ulx3s", "ULX3S (ECP5 LFE5U-85F)", 25000000, "pins.lpf", "ecp5-85",
       "yosys -q -p 'read_verilog -sv '\"$(tr '\\n' ' ' < board/files.f)\"'; synth_ecp5 -top "
       "cuboct_board_top "
       "-json board/top.json'\n"
       "nextpnr-ecp5 --85k --package CABGA381 --freq 25 --json board/top.json --lpf board/pins.lpf "
       "--textcfg board/top.config\n"
       "ecppack --compress board/top.config board/top.bit\n",
       "openFPGALoader -b ulx3s board/top.bit     # or: fujprog board/top.bit\n"}};
  return all;
}

const std::vector<std::string>& buses() {
  static const std::vector<std::string> all{"axi4lite", "wishbone"};
  return all;
}

const Board& board_of(const std::string& name) {
  std::vector<std::string> names;
  for (const Board& board : boards()) {
    if (board.name == name) return board;
    names.push_back(board.name);
  }
  const std::string near = did_you_mean(name, names);
  throw InputError(fmt::format("unknown board '{}'", name), near.empty() ? "one of " + list_of(names) : near);
}

int bit_clocks16(const Board& board, int baud) {
  const int slowest = 300, fastest = board.clock_hz / 4;
  if (baud < slowest || baud > fastest)
    throw InputError(
        fmt::format("{} baud is out of range: {} to {} on the {}", baud, slowest, fastest, board.name));
  return static_cast<int>(std::lround(16.0 * board.clock_hz / baud));
}

std::vector<int> moved_types(const FixedRule& rule) {
  std::vector<int> types;
  for (size_t k = 0; k < rule.types.size(); ++k) {
    const FixedType& type = rule.types[k];
    if (type.pd || type.imposed[0] || type.imposed[1] || type.imposed[2])
      types.push_back(static_cast<int>(k));
  }
  return types;
}

bool sets_velocities(const Plan& plan, const BoardChoice& choice) {
  return choice.velocities && plan.program == nullptr && !moved_types(plan.rule).empty();
}

uint64_t machine_hash(const Plan& plan) {
  FixedRule rule = plan.rule;
  for (const int k : moved_types(rule)) rule.types[static_cast<size_t>(k)].velocity = {};
  return make_plan(std::move(rule), plan.arch, plan.lattice, plan.origin, plan.particles).hash;
}

}  // namespace cuboct
