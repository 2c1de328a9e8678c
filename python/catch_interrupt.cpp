// SPDX-License-Identifier: MIT
#include "python/catch_interrupt.h"

#include <pybind11/pybind11.h>

namespace cuboct {

CatchForHost::CatchForHost() : catching_(std::make_unique<CatchInterrupt>()) {
  const pybind11::gil_scoped_acquire locked;
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

}  // namespace cuboct
