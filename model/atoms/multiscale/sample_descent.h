// SPDX-License-Identifier: MIT
// How far a sample goes downhill at a time, on the host (model/atoms/multiscale/atomic_sample.h) and on a
// device (emu/gpu/samples/sample_kernel.h).
#pragma once

#include <cstdint>

namespace cuboct {

inline constexpr uint32_t kDescentEvaluations = 60;  // before FIRE takes over
// Of 1/stiffness: no step downhill is shorter or longer. Soft modes of silicon samples have 1/100 of the
// stiffest one's curvature.
inline constexpr double kShortestDescent = 0.2, kLongestDescent = 100;
inline constexpr double kLongestMove = 0.1;  // angstrom, of an atom at a time

}  // namespace cuboct
