// SPDX-License-Identifier: MIT
#include "gpu_ref/lps.cpp"
