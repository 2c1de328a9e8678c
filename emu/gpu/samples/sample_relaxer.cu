// SPDX-License-Identifier: MIT
#include "emu/gpu/samples/sample_relaxer.cpp"
