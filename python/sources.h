// SPDX-License-Identifier: MIT
// What Python hands over: a scene and an arch as TOML texts, with the names under which errors know them.
#pragma once

#include <exception>
#include <string>

#include "cli/command.h"
#include "model/base/process.h"

namespace cuboct::python {

struct Sources {
  std::string scene, scene_path;
  std::string arch, arch_path;  // an empty text: the defaults
};

// Throw InputError with the place in the text. The second without `setup.initial`.
Loaded load(const Sources& sources);
Loaded load_plan(const Sources& sources);

// The same as files, which programs read.
Input write_sources(const Sources& sources, const Scratch& scratch);

// Ctrl-C ended what was asked for.
class Interrupted : public std::exception {};

}  // namespace cuboct::python
