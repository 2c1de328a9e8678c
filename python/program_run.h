// SPDX-License-Identifier: MIT
// One run of an engine's program, as part of a run that is stepped from outside.
#pragma once

#include <optional>
#include <string>

#include "cli/run/engine_run.h"

namespace cuboct::python {

// Nothing where an interrupt came before the program began: the state is that from before. Throws as
// EngineRun does, and InputError where the run left less than was asked for. `path`: of the trace.
std::optional<Recorded> run_program(const std::string& engine, const Input& input, const Loaded& loaded,
                                    const EngineOptions& options, RunRequest request,
                                    const std::string& path);

}  // namespace cuboct::python
