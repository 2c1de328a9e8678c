// SPDX-License-Identifier: MIT
// How long computations end that were asked to stop.
#pragma once

#include <exception>

namespace cuboct::study {

// Thrown where model/base/interrupt.h says so (Ctrl-C). No std::runtime_error: those are how a run itself
// ends.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

}  // namespace cuboct::study
