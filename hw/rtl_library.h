// SPDX-License-Identifier: MIT
// The hand-written SystemVerilog modules of rtl/lib, embedded at build time.
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

}  // namespace cuboct
