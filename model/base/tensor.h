// SPDX-License-Identifier: MIT
// The six numbers of a symmetric tensor, in the order of OVITO and LAMMPS.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace cuboct {

inline const std::vector<std::string> kTensorNames{"xx", "yy", "zz", "xy", "xz", "yz"};
// Their rows and columns.
inline constexpr std::array<std::pair<int, int>, 6> kTensorPlaces{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

}  // namespace cuboct
