// SPDX-License-Identifier: MIT
// The blocks behind three C functions. IN and OUT are the numbers of lanes.
#include "Vcuboct_blocks.h"
#include "shim.h"

using Blocks = Instance<Vcuboct_blocks>;

extern "C" {

void* blocks_create() { return new Blocks(3); }  // registers start as random bits
void blocks_destroy(void* handle) { delete static_cast<Blocks*>(handle); }

// One clock cycle: `out` is what the ports show during it.
void blocks_clock(void* handle, bool reset_n, const uint64_t* in, uint64_t* out) {
  Vcuboct_blocks& m = *static_cast<Blocks*>(handle)->model;
  m.rst_ni = reset_n;
  set_port(m.in_i, in);
  m.clk_i = 0;
  m.eval();
  get_port(m.out_o, out);
  m.clk_i = 1;
  m.eval();
}

}  // extern "C"
