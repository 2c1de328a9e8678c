// SPDX-License-Identifier: MIT
#include "emu/gpu/fixed/fixed_policy.cpp"
