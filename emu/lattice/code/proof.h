// SPDX-License-Identifier: MIT
// Compiled code beside the interpreter, before the first step by it.
#pragma once

#include "emu/lattice/code/code_pass.h"
#include "emu/lattice/code/finish_code_pass.h"

namespace cuboct::emu {

// Runs some 4,096 random pairs by both: positions, velocities and fields within their ranges, lanes that
// count and lanes that do not. Throws InputError where a sum, a bond or a refusal differs: the compiler is
// not to be trusted with this rule.
void prove(const CodePass& code, PairPass& pass, const graph::FixedProgram& program,
           const graph::Round& round, const BondSpace& space, bool once);

// The same of some 4,096 random particles and their sums, some of them asleep: fields, velocities,
// displacements, places and crossings. `round`: of the program, as of `code`.
void prove(const FinishCodePass& code, const graph::FixedProgram& program, const KernelRule& rule,
           size_t round);

}  // namespace cuboct::emu
