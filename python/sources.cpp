// SPDX-License-Identifier: MIT
#include "python/sources.h"

#include "model/base/output.h"

namespace cuboct::python {
namespace {

Arch arch_of(const Sources& sources) {
  return sources.arch.empty() ? read_arch("") : parse_arch(sources.arch, sources.arch_path);
}

}  // namespace

Loaded load(const Sources& sources) {
  Loaded loaded{parse_scene(sources.scene, sources.scene_path), {}};
  loaded.setup = make_setup(loaded.scene, arch_of(sources));
  return loaded;
}

Loaded load_plan(const Sources& sources) {
  Loaded loaded{parse_scene(sources.scene, sources.scene_path), {}};
  loaded.setup.plan = plan_of(loaded.scene, arch_of(sources));
  return loaded;
}

Input write_sources(const Sources& sources, const Scratch& scratch) {
  Input input{.scene = scratch.path("scene.toml"), .arch = {}};
  write_text(input.scene, sources.scene);
  if (sources.arch.empty()) return input;
  input.arch = scratch.path("arch.toml");
  write_text(input.arch, sources.arch);
  return input;
}

}  // namespace cuboct::python
