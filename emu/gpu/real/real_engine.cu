// SPDX-License-Identifier: MIT
#include "emu/gpu/real/real_engine.cpp"
