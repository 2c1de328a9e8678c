// SPDX-License-Identifier: MIT
// The proof that a program's values fit, as text: a line for each node with its operation and its interval. A
// checker that shares no code with the builder accepts it, or refuses a line.
#pragma once

#include <string>

#include "model/graph/program.h"

namespace cuboct::graph {

std::string certificate_of(const FixedProgram& program);

struct Refusal {
  int line = 0;  // counted from 1; 0 where the text is accepted
  std::string what;
};
// Whether each interval follows from those before it. Formats and constants' ranges are taken as they are
// told.
Refusal refusal_of(const std::string& certificate);

}  // namespace cuboct::graph
