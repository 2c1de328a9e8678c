// SPDX-License-Identifier: MIT
// The hand-written SystemVerilog modules of rtl/lib, rtl/lattice, rtl/pipeline, rtl/rounds, rtl/bus, and of
// rtl/board with the boards' pins, embedded at build time.
#pragma once

#include <string_view>
#include <vector>

namespace cuboct {

struct RtlSource {
  std::string_view name;  // file name, e.g. "cuboct_fifo.sv"
  std::string_view text;
};

// In the order of names.
const std::vector<RtlSource>& rtl_library();
const std::vector<RtlSource>& rtl_lattice_library();
const std::vector<RtlSource>& rtl_bus_library();
// What nodes need that run a rule of text: of its pipelines, and around its rounds.
const std::vector<RtlSource>& rtl_pipeline_library();
const std::vector<RtlSource>& rtl_rounds_library();
// The pages of docs/reference that the modules' comments name.
const std::vector<RtlSource>& rtl_pages();
// Those of one board alone are called "BOARD/name".
const std::vector<RtlSource>& rtl_board_library();

}  // namespace cuboct
