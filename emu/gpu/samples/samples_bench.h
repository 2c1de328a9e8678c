// SPDX-License-Identifier: MIT
// `cuboct-gpu samples`: how fast a device computes many small periodic samples of silicon or diamond, what
// energy that takes, and how far its floats are from doubles. docs/reference/samples.md.
#pragma once

namespace cuboct::gpu {

// argv[0] is "samples". Exit code: 0, 1 where the device failed or an interrupt came, 2 for bad arguments or
// without a device.
int run_samples_bench(int argc, char** argv);

}  // namespace cuboct::gpu
