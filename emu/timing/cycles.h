// SPDX-License-Identifier: MIT
// What the parts of the timing model share.
#pragma once

#include <cstddef>
#include <cstdint>

#include "model/trace/trace.h"

namespace cuboct::emu {

// An end beat loaded in cycle t is seen by its sender (`sent`) in t + 1, by its receiver in t + 2: through
// the sender's output register and the receiver's; `LinkCode::latency` comes to the latter.
inline constexpr int64_t kSent = 1, kReceived = 2;
// A particle is seen a cycle later: its memory answers then. Of a narrow memory it is read word by word.
inline constexpr int64_t kAnswered = 1;
// Before any cycle: a link or an engine that has done nothing yet, the end beat of a face without link.
inline constexpr int64_t kLongAgo = INT64_MIN / 4;
// A step costs about 50 ns per node and 100 ns per particle. A thread must have enough of it beside the
// barriers of the step: in units of a node's 50 ns.
inline constexpr int64_t kWorkPerThread = 1000;

constexpr size_t at(int index) { return static_cast<size_t>(index); }
constexpr size_t at(Phase phase) { return static_cast<size_t>(phase); }

}  // namespace cuboct::emu
