// SPDX-License-Identifier: MIT
#include "gpu_ref/fixed_policy.cpp"
