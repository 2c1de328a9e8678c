// SPDX-License-Identifier: MIT
#include "gpu_ref/samples.cpp"
