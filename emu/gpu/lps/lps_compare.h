// SPDX-License-Identifier: MIT
// The peridynamic solid on a device beside the reference engine, from one state on.
#pragma once

#include "emu/gpu/lps/lps.h"
#include "model/real/real_engine.h"

namespace cuboct::gpu {

// Largest differences over the largest value of the reference; of damage, which is a share, the difference.
struct LpsErrors {
  double displacement = 0, velocity = 0, dilatation = 0, damage = 0;
};

// The terms of an engine of model/real/rounds_engine.h. InputError where its rule is another.
const LpsTerms& lps_terms_of(const RealEngine& reference);

// Puts the reference where the device is, with its bonds, and makes `steps` steps of both. Displacements
// count from `packed`. `seconds`, where given: what the reference's steps took.
LpsErrors lps_errors(LpsDevice& device, RealEngine& reference, const Body& packed, uint64_t steps,
                     double* seconds = nullptr);

}  // namespace cuboct::gpu
