// SPDX-License-Identifier: MIT
// What a thread has room for.
#pragma once

namespace cuboct::gpu {

inline constexpr int kTogether = 4;  // partners that an interpreted operation takes at once
inline constexpr int kMostRegisters = 128;
inline constexpr int kMostBondNumbers = 8;
inline constexpr int kMostNumbers = 32;  // of a particle's fields; of a round's sums

}  // namespace cuboct::gpu
