// SPDX-License-Identifier: MIT
// Units of atoms, in those of the SI.
#pragma once

namespace cuboct {

inline constexpr double kElectronVolt = 1.602176634e-19;  // J, exact since 2019
inline constexpr double kAngstrom = 1e-10;                // m
inline constexpr double kPicosecond = 1e-12;              // s

}  // namespace cuboct
