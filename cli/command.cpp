// SPDX-License-Identifier: MIT
#include "cli/command.h"

namespace cuboct {

void Input::add_to(CLI::App& command) {
  command.add_option("scene", scene, "scene file (TOML)")->required()->type_name("SCENE");
  command.add_option("--arch", arch, "machine description (TOML)")->type_name("FILE");
}

Loaded load(const Input& input) {
  Loaded loaded{read_scene(input.scene), {}};
  loaded.setup = make_setup(loaded.scene, read_arch(input.arch));
  return loaded;
}

}  // namespace cuboct
