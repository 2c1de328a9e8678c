// SPDX-License-Identifier: MIT
// Which rank owns which cell.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/contract/lattice.h"

namespace cuboct::emu {

// By cell, its rank. `how`: "bricks" (bisection across the longest side, x counted half, recursively: after
// Berger and Bokhari 1987) or slabs along "x", "y" or "z"; parts hold about the same sum of `weight` (by
// cell) each. InputError where `how` is none of these.
std::vector<uint16_t> cut_cells(const Lattice& lattice, const std::vector<uint16_t>& weight, int ranks,
                                const std::string& how);

}  // namespace cuboct::emu
