// SPDX-License-Identifier: MIT
// `cuboct-gpu lps SCENE`: a scene of the linear peridynamic solid on a device, how fast it runs and what
// energy that takes, where its cracks go, and how far its numbers are from the reference engine's.
// docs/reference/peridynamics.md, "On a GPU".
#pragma once

namespace cuboct::gpu {

// argv[0] is "lps". Exit code: 0, 1 where the device failed or an interrupt came, 2 for bad arguments, a
// scene that cannot be, or without a device.
int run_lps_bench(int argc, char** argv);

}  // namespace cuboct::gpu
