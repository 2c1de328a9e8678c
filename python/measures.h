// SPDX-License-Identifier: MIT
// Measures of frames (model/analysis/measurement.h) for Python.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "model/scene/scene.h"

namespace cuboct::python {

// What a run's states mean to those who measure them.
struct Matter {
  std::shared_ptr<const Scene> scene;
  bool wrapped = false;  // as Snapshot has it
  double late = 0;       // s, the same
};

// Matter with its measure(), and measure() of a directory.
void add_measures(pybind11::module_& module);

}  // namespace cuboct::python
