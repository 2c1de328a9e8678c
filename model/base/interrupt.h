// SPDX-License-Identifier: MIT
// Ctrl-C (SIGINT; or SIGTERM, or SIGHUP of a terminal that goes, or SIGUSR1, which mpirun passes on) ends a
// run after the step at hand, so that what was done can be written; a second one, half a second later or
// more, ends the program. To be caught where the stepping begins: before, nothing asks `interrupted`.
#pragma once

namespace cuboct {

void catch_interrupts();
bool interrupted();
// False again: who asks for it has ended the run, and waits for something else.
void forget_interrupt();

// Within a program whose handlers are its own, such as Python: while any of these lives Ctrl-C alone is
// caught, however often it comes, and nothing ends the program. Afterwards the handler of before is back, and
// `interrupted` is false again.
class CatchInterrupt {
 public:
  CatchInterrupt();
  ~CatchInterrupt();
  CatchInterrupt(const CatchInterrupt&) = delete;
  CatchInterrupt& operator=(const CatchInterrupt&) = delete;
};

}  // namespace cuboct
