// SPDX-License-Identifier: MIT
// What a reading takes from a body in real numbers.
#pragma once

#include <vector>

#include "model/analysis/reading.h"

namespace cuboct {

// m/s, at the time of the positions, which is `late` (s) after that of the body's. `force`: N, on each
// particle, without gravity and controllers; of no account where `late` is 0.
std::vector<Vec3> velocities_at(const Rule& rule, const Body& body, const std::vector<Vec3>& force,
                                double late);

// Of the particles that are asked for, and of all the energies of motion and of gravity. `force` as above,
// and `v` at the time of the positions, by id: empty where nothing asked for needs them.
Reading read_body(const Rule& rule, const Body& body, const std::vector<Vec3>& force,
                  const std::vector<Vec3>& v, const Asked& asked);

}  // namespace cuboct
