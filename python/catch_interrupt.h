// SPDX-License-Identifier: MIT
// Ctrl-C while a call of the module runs.
#pragma once

#include "model/base/interrupt.h"

namespace cuboct {

// Catches Ctrl-C from here on. One that Python took down between the call and here is heard as well, in
// Python's main thread: no bytecode would be run before the call ends. Called without the interpreter's lock.
class CatchFromPython : CatchInterrupt {
 public:
  CatchFromPython();
};

}  // namespace cuboct
