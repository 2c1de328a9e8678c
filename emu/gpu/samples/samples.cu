// SPDX-License-Identifier: MIT
#include "emu/gpu/samples/samples.cpp"
