// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/rounds_engine.cpp"
