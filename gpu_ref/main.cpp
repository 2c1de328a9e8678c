// SPDX-License-Identifier: MIT
#include "gpu_ref/program.h"

int main(int argc, char** argv) { return cuboct::gpu::run_gpu_program(argc, argv); }
