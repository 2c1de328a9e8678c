// SPDX-License-Identifier: MIT
// The two ways of `cuboct emit`: the arch as it is, or --fit, which a build without synthesis refuses.
#pragma once

#include <optional>
#include <string>

#include "cli/answer.h"
#include "cli/command.h"
#include "hw/rtl/rtl_emit.h"

namespace cuboct {

// Chooses the arch for a device and writes the project. Throws Failed where a tool failed or somebody
// interrupted.
void emit_fitted(const Input& input, const std::string& target, const std::string& out, Emission emission,
                 const Answer& answer);

// Throws InputError with the numbers where the board's FPGA has no room for the plan, Failed where a tool
// failed or somebody interrupted. Says on stderr what could not be checked.
void check_board(const Input& input, const Plan& plan, const State& initial, const BoardChoice& board);

// What ends an emission: a line for people, and for scripts.
Items say_emitted(const std::string& out, const Plan& plan, const std::optional<CountedCycles>& counted,
                  const Answer& answer);

}  // namespace cuboct
