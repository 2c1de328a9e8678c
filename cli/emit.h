// SPDX-License-Identifier: MIT
// The two ways of `cuboct emit`: the arch as it is, or --fit, which a build without synthesis refuses.
#pragma once

#include <cstdint>
#include <string>

#include "cli/command.h"
#include "hw/board.h"

namespace cuboct {

// Chooses the arch for a device and writes the project. 0, or 1 where a tool failed or somebody interrupted.
int emit_fitted(const Input& input, const std::string& target, const std::string& out, uint64_t vector_steps,
                const BoardChoice& board);

// The line that ends an emission.
void say_emitted(const std::string& out, const Plan& plan);

}  // namespace cuboct
