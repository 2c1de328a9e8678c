// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/real_rounds_engine.cpp"
