// SPDX-License-Identifier: MIT
#include "hw/engine/engines.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/error.h"
#include "model/base/spelling.h"

namespace cuboct {

// Costs: one thread of an idle Xeon (Sapphire Rapids) with scenes/bench: 18 neighbours in a crystal, 55 in a
// liquid.
const std::vector<EngineRow>& engines() {
  const char* kNeverStands =
      "its nodes are never all at the same step: a node begins one while others end the last";
  static const std::vector<EngineRow> rows{
      {.name = "golden",
       .here = Here::golden,
       .text = true,
       .any_cells = true,
       .cost = {40e-9, 0, false, 600, 10, 100}},
      {.name = "lattice",
       .here = Here::lattice,
       .text = true,
       .any_cells = true,
       .studied = true,
       .counts_if_asked = true,
       .rule_codes = {"automatic", "interpreted", "compiled"},
       .hash_every = 100,
       .ranks = "cuboct-lattice",
       .cost = {3e-9, 1.5e-9, true, 320, 3.5, 70}},
      {.name = "systemc",
       .text = true,
       .links = true,
       .cycles = true,
       .unsaved = kNeverStands,
       .program = "cuboct-systemc",
       .needs = "install libsystemc-dev and build again; a directory of 'cmake --install' has no such engine",
       .cost = {0, 0, true, 600, 0, 50e3}},
      {.name = "rtl",
       .text = true,
       .links = true,
       .cycles = true,
       .unsaved = kNeverStands,
       .program = "cuboct-rtl",
       .needs = "install verilator and libsystemc-dev and build again; a directory of 'cmake --install' has "
                "no such engine",
       .cost = {0, 0, true, 600, 0, 15e3}},
      {.name = "fpga",
       .text = true,
       .port = true,
       .hash_every = 0,
       .program = "cuboct-fpga",
       .needs = "install zlib1g-dev and build again; a directory of 'cmake --install' has no such engine",
       .cost = {0, 0, false, 600, 0, 70}},
      {.name = "gpu",
       .text = true,
       .any_cells = true,
       .real = true,
       .studied = true,
       .devices = true,
       .rule_codes = {"automatic", "interpreted"},
       .hash_every = 100,
       .program = "cuboct-gpu",
       .needs = "install the CUDA toolkit (nvcc), configure and build again",
       .cost = {0, 0, false, 250, 0, 70}},
      {.name = "reference",
       .here = Here::reference,
       .bits = false,
       .real = true,
       .integrators = true,
       .studied = true,
       .hash_every = 0,
       .cost = {2.5e-9, 0, true, 700, 6, 70}},
  };
  return rows;
}

const EngineRow* find_engine(const std::string& name) {
  const auto row = std::ranges::find(engines(), name, &EngineRow::name);
  return row == engines().end() ? nullptr : &*row;
}

const EngineRow& engine_row(const std::string& name, bool bits) {
  if (const EngineRow* row = find_engine(name); row && (row->bits || !bits)) return *row;
  const auto allowed = engines_that([bits](const EngineRow& row) { return row.bits || !bits; });
  const std::string near = did_you_mean(name, allowed);
  throw InputError(fmt::format("unknown engine '{}'", name),
                   near.empty() ? "one of " + list_of(allowed) : near);
}

}  // namespace cuboct
