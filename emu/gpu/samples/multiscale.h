// SPDX-License-Identifier: MIT
// `cuboct-gpu multiscale`: a study of elements whose samples a device brings to rest.
#pragma once

namespace cuboct::gpu {

// Brings a study's file of progress to its end, which `cuboct multiscale --gpu` then reads. Returns the exit
// code: 0 done, 1 a body failed or the run was interrupted (the progress is there), 2 the input or the
// command line is wrong, or there is no device.
int run_multiscale(int argc, char** argv);

}  // namespace cuboct::gpu
