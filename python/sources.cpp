// SPDX-License-Identifier: MIT
#include "python/sources.h"

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

}  // namespace cuboct::python
