// SPDX-License-Identifier: MIT
// The RTL generator: a plan becomes a self-contained SystemVerilog project.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hw/plan/plan.h"
#include "hw/rtl/board.h"
#include "hw/rtl/rtl_project.h"
#include "model/contract/state.h"

namespace cuboct {

struct Emission {
  uint64_t vector_steps = 1;  // of golden, for the bench
  BoardChoice board = {};
  std::string prefix = {};  // of all names: hw/rtl/rtl_prefix.h; empty: none
  std::string arch = {};    // text of arch.toml, which the README names; nothing where it is empty
  std::optional<CountedCycles> counted = {};  // for project.json
};

// Writes into `dir` (created; must be empty or hold an earlier emission): rtl/ (library modules and what is
// generated: cuboct_pkg.sv, tables, cuboct_node.sv, cuboct_lattice.sv), bench/ with vectors from golden,
// files.f, project.json, README.md. With a board also board/: its top module cuboct_board_top, what that
// needs beside the lattice, pins, and files.f of all. With a bus likewise bus/, with the top module
// cuboct_axi4lite or cuboct_wishbone. Same plan, same bytes. Throws InputError.
void emit_rtl(const Plan& plan, const State& initial, const std::string& dir, const Emission& emission = {});
// Throws InputError where emit_rtl would refuse the plan, or the choice of a board, a bus or a prefix.
void check_emission(const Plan& plan, const Emission& emission);
// Throws InputError where emit_rtl would refuse the directory as another's.
void check_emit_directory(const std::string& dir);

// The node alone (rtl/ without lattice and bench), for the Verilated engine.
void emit_node(const Plan& plan, const std::string& dir);

}  // namespace cuboct
