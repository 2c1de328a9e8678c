// SPDX-License-Identifier: MIT
// Which frames of a run to picture.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "model/trace/trace.h"

namespace cuboct {

// Frames that tell the story, by their index, ascending: the start, the first broken bond (`onset`), the
// largest value of `stress` (null: there is none), a quarter of the way from there to the end, the end; where
// those fall together, evenly spread ones too. `steps`: of the frames, ascending; one or more.
std::vector<size_t> story_frames(const std::vector<uint64_t>& steps, const Curve* stress,
                                 std::optional<size_t> onset);

}  // namespace cuboct
