// SPDX-License-Identifier: MIT
#include "python/program_run.h"

#include <stdexcept>
#include <utility>

#include "model/base/error.h"
#include "model/base/interrupt.h"

namespace cuboct::python {

std::optional<Recorded> run_program(const std::string& engine, const Input& input, const Loaded& loaded,
                                    const EngineOptions& options, RunRequest request,
                                    const std::string& path) {
  std::optional<Recorded> run;
  try {
    run = EngineRun(engine, input, loaded, options, std::move(request), path, true).finish();
  } catch (const std::runtime_error&) {
    if (interrupted()) return std::nullopt;
    throw;
  }
  if (!run->trouble.empty()) throw InputError(run->trouble);
  return run;
}

}  // namespace cuboct::python
