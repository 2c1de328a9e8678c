// SPDX-License-Identifier: MIT
// A rule that is text on one or more GPUs of one host: its program of integers runs as it stands, a thread
// for each particle, with golden's bits after every step. A step that may not be possible is golden's own, on
// the host, so that errors are too.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "emu/gpu/engine.h"
#include "hw/plan/plan.h"
#include "model/run/integer_engine.h"

namespace cuboct::gpu {

// Makes of text_of (rounds_text.h) a file that a device of an architecture ("sm_90") loads. A
// std::runtime_error's text says why there is none.
using CompileRounds = std::function<std::string(const std::string& source, const std::string& architecture)>;

// Without `compile`, or where that fails, or where a compiled step differs, operations are interpreted: a
// note of the engine ("kernels") says which it is, and why. `plan` has a program; it must outlive the engine.
// InputError where the program needs more than a thread has, a device is not there, or there are fewer planes
// of cells than devices; std::runtime_error where CUDA fails.
std::unique_ptr<IntegerEngine> make_rounds_engine(const Plan& plan, const State& initial,
                                                  const Options& options, const CompileRounds& compile = {});

}  // namespace cuboct::gpu
