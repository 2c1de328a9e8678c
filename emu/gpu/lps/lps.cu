// SPDX-License-Identifier: MIT
#include "emu/gpu/lps/lps.cpp"
