// SPDX-License-Identifier: MIT
// Ctrl-C while a call from a program that is not ours lasts.
#pragma once

#include <memory>

#include "model/base/interrupt.h"

namespace cuboct {

// Each library that is linked to a host has the constructor that suits it. Python's module catches Ctrl-C
// from here on; one that Python took down between the call and here is heard as well, in Python's main
// thread: no bytecode would be run before the call ends. It is called without the interpreter's lock. The C++
// library leaves signals to its program.
class CatchForHost {
 public:
  CatchForHost();

 private:
  std::unique_ptr<CatchInterrupt> catching_;
};

}  // namespace cuboct
