// SPDX-License-Identifier: MIT
// What Python hands over: a scene and an arch as TOML texts, with the names under which errors know them.
#pragma once

#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "model/base/process.h"

namespace cuboct::python {

struct Sources {
  std::string scene, scene_path;
  std::string arch, arch_path;  // an empty text: the defaults
  std::string stage{}, from{};  // model/run/start.h; an empty stage: the first, where the scene has stages
};

// The scene with its plan, or what stands for one. Throws InputError with the place in the text.
// `looks_only`: a later stage may do without `from`.
Loaded load_plan(const Sources& sources, bool looks_only = false, const std::string& engine = "",
                 bool real = false);
std::vector<StageName> stages_of(const Sources& sources);
// Throws InputError where the stage cannot be read, wherever it is to begin.
void read_stage(const Sources& sources);

// The same as files, which programs read: the scene's own where it is what the file holds.
Input write_sources(const Sources& sources, const Scratch& scratch);

// By name what a [rule] shows of its particles, [particle x its numbers]; none of pair laws.
using Fields = std::vector<std::pair<std::string, std::vector<double>>>;

// Ctrl-C ended what was asked for.
class Interrupted : public std::exception {};

}  // namespace cuboct::python
