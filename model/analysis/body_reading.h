// SPDX-License-Identifier: MIT
// What a reading takes from a body in real numbers.
#pragma once

#include <vector>

#include "model/analysis/reading.h"
#include "model/base/mat3.h"

namespace cuboct {

// m/s, at the time of the positions, which is `late` (s) after that of the body's. `force`: N, on each
// particle, without gravity and controllers; of no account where `late` is 0.
std::vector<Vec3> velocities_at(const Rule& rule, const Body& body, const std::vector<Vec3>& force,
                                double late);

// Of the particles that are asked for, and of all the energies of motion and of gravity. `force` as above,
// and `v` at the time of the positions, by id: empty where nothing asked for needs them.
Reading read_body(const Rule& rule, const Body& body, const std::vector<Vec3>& force,
                  const std::vector<Vec3>& v, const Asked& asked);

// Of each set the sum of its particles' stress times volume, J. `virial`: by id, without the kinetic part;
// `v`: m/s at the time of the positions, by id, empty where no set takes that part.
std::vector<Mat3> summed_stress(const Rule& rule, const std::vector<uint8_t>& type,
                                const std::vector<Vec3>& v, const std::vector<Mat3>& virial,
                                std::span<const AskedStress> sets);

}  // namespace cuboct
