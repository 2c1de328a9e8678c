// SPDX-License-Identifier: MIT
#include "gpu_ref/rounds_engine.cpp"
