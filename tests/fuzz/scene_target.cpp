// SPDX-License-Identifier: MIT
// Scenes, and rules that are text.
#include <string>

#include "model/run/start.h"
#include "model/scene/scene.h"
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {

void take_scene(Bytes input) {
  refusing([&] {
    // Files that the scene names are those beside the scenes of the tree.
    const std::string text = text_of(input), path = in_tree("scenes/fuzzed.toml");
    const auto stages = stages_in(text, path);
    const std::string stage = stages.empty() ? "" : stages.back().name;
    load_scene(text, path, {.stage = stage, .from = {}, .looks_only = true});
  });
}

void take_rule(Bytes input) {
  refusing([&] {
    const std::string path = file_of(input, "rule.toml");
    parse_scene("rule = \"" + path + R"("
density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[geometry]
shape = "box"
size = "[2, 2, 2] mm"
[run]
dt = "1 us"
steps = 3
)",
                in_tree("scenes/fuzzed.toml"));
  });
}

}  // namespace cuboct::fuzz
