// SPDX-License-Identifier: MIT
// How wide the sums of a round are in hardware.
#pragma once

#include "hw/pipeline/schedule.h"
#include "model/graph/program.h"

namespace cuboct::pipeline {

// Bits of two's complement that hold a value of this form.
inline int signed_bits(const Form& form) { return form.bits + (form.is_signed ? 0 : 1); }

// Of what the pipeline of a round's pair, as `schedule` has it, adds to a component of its sum number `sum`.
int kick_bits(const graph::Round& round, const Schedule& schedule, int sum);
// Of a component of the sum, over all partners that a particle can have.
int sum_bits(const graph::FixedProgram& program, const graph::Round& round, const Schedule& schedule,
             int sum);

}  // namespace cuboct::pipeline
