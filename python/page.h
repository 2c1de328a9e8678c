// SPDX-License-Identifier: MIT
// States that Python holds, as the page of a run (docs/user/view.md), which a program of ours writes.
#pragma once

#include <string>
#include <vector>

#include "model/run/engine.h"
#include "model/trace/trace.h"
#include "python/sources.h"

namespace cuboct::python {

struct Shown {
  Sources sources;
  std::string engine;
  bool real = false;  // the states are in real numbers, whatever the engine
  std::vector<RunState> states;
  Trace trace;  // the rest
};

// The page, as HTML. `words`: options of `cuboct view --save`. InputError as that tells it.
std::string page_of(const Shown& shown, const std::vector<std::string>& words);

}  // namespace cuboct::python
