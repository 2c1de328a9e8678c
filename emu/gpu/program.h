// SPDX-License-Identifier: MIT
// The command line of `cuboct-gpu`: scene and arch in, trace out.
#pragma once

namespace cuboct::gpu {

// Parses, runs, writes the trace. Returns the exit code: 0 done, 1 the run stopped on a fault, was
// interrupted, or its watch found something (the trace is written all the same), 2 the input or the command
// line is wrong, or there is no device.
int run_gpu_program(int argc, char** argv);

// The same of a run that goes on beside others of this process (emu/gpu/many.h). It says nothing but errors.
// Scenes of more than kMostTogether particles, and rules of text, wait until they have the device alone.
int run_among_many(int argc, char** argv);

}  // namespace cuboct::gpu
