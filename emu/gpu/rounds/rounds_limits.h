// SPDX-License-Identifier: MIT
// What a thread has room for.
#pragma once

namespace cuboct::gpu {

inline constexpr int kMostRegisters = 64;
inline constexpr int kMostBondNumbers = 8;
inline constexpr int kMostNumbers = 32;  // of a particle's fields; of a round's sums

}  // namespace cuboct::gpu
