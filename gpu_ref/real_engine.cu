// SPDX-License-Identifier: MIT
#include "gpu_ref/real_engine.cpp"
