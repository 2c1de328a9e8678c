// SPDX-License-Identifier: MIT
// A rule of several rounds, stepped in doubles. Exchanges cost nothing here: all particles are in one memory.
#pragma once

#include <memory>

#include "model/real/real_engine.h"

namespace cuboct {

// The step is that of Integrator::semi_implicit_euler with the last round's force in the place of the pairs',
// or velocity Verlet. InputError for floats, for a rule that damps by pairs, and where the body does not fit.
std::unique_ptr<RealEngine> make_rounds_engine(const Rule& rule, const Body& body, const Periodic& periodic,
                                               const RealOptions& options);

}  // namespace cuboct
