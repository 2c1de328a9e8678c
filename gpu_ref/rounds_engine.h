// SPDX-License-Identifier: MIT
// A rule that is text on one GPU: its program of integers runs as it stands, a thread for each particle, with
// golden's bits after every step. A step that may not be possible is golden's own, on the host, so that
// errors are too.
#pragma once

#include <memory>

#include "gpu_ref/engine.h"
#include "hw/plan.h"
#include "model/run/integer_engine.h"

namespace cuboct::gpu {

// `plan` has a program; it must outlive the engine. InputError where the program needs more than a thread
// has, or several devices are asked for; std::runtime_error where CUDA fails.
std::unique_ptr<IntegerEngine> make_rounds_engine(const Plan& plan, const State& initial,
                                                  const Options& options);

}  // namespace cuboct::gpu
