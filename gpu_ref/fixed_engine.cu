// SPDX-License-Identifier: MIT
#include "gpu_ref/fixed_engine.cpp"
