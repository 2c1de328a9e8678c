// SPDX-License-Identifier: MIT
// The gpu engine in real numbers against the reference in doubles: forces and short runs, within bounds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/run/engine_run.h"

namespace cuboct {

// In the precision of `choice`, float or double; `steps`: without it the scene's, but kRealSteps at most.
// Forces are compared at the start and at the end, positions where errors can be told from a wrong program:
// as late as their bound is below kRealTold of the cutoff. Prints what it measured beside its bounds; the
// exit code is 1 where one is exceeded or the run had to stop. `out`: directory of the gpu's trace, or empty.
inline constexpr uint64_t kRealSteps = 100;
constexpr double kRealTold(bool floats) { return floats ? 1e-4 : 1e-10; }
int crosscheck_real(const Input& input, const EngineOptions& choice, std::optional<uint64_t> steps,
                    const std::string& out, const Answer& answer);

}  // namespace cuboct
