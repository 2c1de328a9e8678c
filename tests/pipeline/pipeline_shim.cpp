// SPDX-License-Identifier: MIT
// Pipelines side by side behind three C functions: lanes of 64 bits in and out, and a bit each for valid.
#include "Vcuboct_pipelines.h"
#include "shim.h"

using Pipelines = Instance<Vcuboct_pipelines>;

extern "C" {

void* pipelines_create() { return new Pipelines(3); }  // registers start as random bits
void pipelines_destroy(void* handle) { delete static_cast<Pipelines*>(handle); }

// One clock cycle: outputs are what the ports show during it.
void pipelines_clock(void* handle, bool reset_n, bool valid, const uint64_t* in, uint64_t* out) {
  Vcuboct_pipelines& m = *static_cast<Pipelines*>(handle)->model;
  m.rst_ni = reset_n;
  m.valid_i = valid;
  set_port(m.in_i, in);
  m.clk_i = 0;
  m.eval();
  get_port(m.out_o, out);
  m.clk_i = 1;
  m.eval();
}

}  // extern "C"
