// SPDX-License-Identifier: MIT
#include "emu/gpu/bench/bench.h"

namespace cuboct::gpu {

int run_bench(int argc, char** argv) {
  return run_bench(argc, argv,
                   {.devices = find_devices,
                    .fixed = make_fixed_engine,
                    .real = make_real_engine,
                    .copy_bandwidth = copy_bandwidth});
}

}  // namespace cuboct::gpu
