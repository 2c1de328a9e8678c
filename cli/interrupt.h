// SPDX-License-Identifier: MIT
// Ctrl-C ends a run after the step at hand, so that what was done can be written; a second one ends the
// program.
#pragma once

namespace cuboct {

void catch_interrupts();
bool interrupted();

}  // namespace cuboct
