// SPDX-License-Identifier: MIT
#include "python/sources.h"

#include <filesystem>

#include "hw/engine/scene_engine.h"
#include "model/base/output.h"
#include "model/config/config.h"
#include "model/run/start.h"

namespace cuboct::python {
namespace {

Arch arch_of(const Sources& sources) {
  return sources.arch.empty() ? read_arch("") : parse_arch(sources.arch, sources.arch_path);
}

std::string stage_of(const Sources& sources) {
  if (!sources.stage.empty()) return sources.stage;
  const std::vector<StageName> names = stages_of(sources);
  return names.empty() ? "" : names.front().name;
}

bool is_in_file(const std::string& text, const std::string& path) {
  return std::filesystem::is_regular_file(path) && read_config_text(path) == text;
}

}  // namespace

Loaded load_plan(const Sources& sources, bool looks_only, const std::string& engine, bool real) {
  Loaded loaded{load_scene(sources.scene, sources.scene_path, {stage_of(sources), sources.from, looks_only}),
                {}};
  loaded.setup.plan = scene_plan_of(loaded.scene, arch_of(sources), engine, real);
  return loaded;
}

std::vector<StageName> stages_of(const Sources& sources) {
  return stages_in(sources.scene, sources.scene_path);
}

void read_stage(const Sources& sources) {
  parse_scene(sources.scene, sources.scene_path, {.begins = true, .stage = stage_of(sources)});
}

Input write_sources(const Sources& sources, const Scratch& scratch) {
  Input input{.scene = sources.scene_path, .arch = {}};
  input.stage = stage_of(sources);
  input.from = sources.from;
  if (!is_in_file(sources.scene, sources.scene_path)) {
    input.scene = scratch.path("scene.toml");
    input.scene_path = sources.scene_path;
    write_text(input.scene, sources.scene);
  }
  if (sources.arch.empty()) return input;
  input.arch = scratch.path("arch.toml");
  write_text(input.arch, sources.arch);
  return input;
}

}  // namespace cuboct::python
