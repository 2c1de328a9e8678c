// SPDX-License-Identifier: MIT
// What a reading takes from a body in real numbers.
#pragma once

#include <vector>

#include "model/analysis/reading.h"

namespace cuboct {

// Of the particles that are asked for, and of all the energies of motion and of gravity. `force`: N, on each
// particle, without gravity and controllers. `late`: s, from the time of the velocities to that of the
// positions.
Reading read_body(const Rule& rule, const Body& body, const std::vector<Vec3>& force, double late,
                  const Asked& asked);

}  // namespace cuboct
