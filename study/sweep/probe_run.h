// SPDX-License-Identifier: MIT
// A run of a scene for the readings of its probes alone: no frames, no hashes.
#pragma once

#include <cstdint>
#include <string>

#include "hw/arch/arch.h"
#include "model/run/record.h"

namespace cuboct::study {

// To the scene's end, or where its `until` holds. `engine`: "lattice" or "reference"; static loading is
// always relaxed in doubles. Throws Interrupted; InputError where the scene makes no machine;
// std::runtime_error where static loading finds no rest.
Trace probe_run(const Scene& scene, const Arch& arch, const std::string& engine, int threads);

// Rounds of forces, times particles.
uint64_t particle_steps(const Scene& scene, const Trace& trace);

}  // namespace cuboct::study
