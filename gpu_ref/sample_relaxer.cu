// SPDX-License-Identifier: MIT
#include "gpu_ref/sample_relaxer.cpp"
