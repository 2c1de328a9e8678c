// SPDX-License-Identifier: MIT
#include "cli/run/load_any.h"

#include <fmt/format.h>

#include "hw/engine/scene_engine.h"
#include "model/rules/rounds_rule.h"
#include "model/run/start.h"

namespace cuboct {

Loaded load_any(const Input& input, const std::string& engine, bool real) {
  Loaded loaded{load_scene(input.scene, {input.stage, input.from, input.looks_only}), {}};
  loaded.setup.plan = scene_plan_of(loaded.scene, read_arch(input.arch), engine, real);
  return loaded;
}

void add_rounds(Items& items, const Scene& scene) {
  const RoundsRule* rule = scene.rule.rounds.get();
  if (rule == nullptr) return;
  for (const auto& lines : {lines_of(rule->declaration()), rule->settings()})
    for (const DeclarationLine& line : lines) items.add(line.name, line.text, line.note);
}

std::string plan_text(const Loaded& loaded) {
  Items items;
  if (loaded.scene.rule.rounds != nullptr)
    add_rounds(items, loaded.scene);
  else if (!has_machine(loaded.setup.plan))
    items.add("machine", std::string(kNoFormats));
  else
    return describe(loaded.setup.plan);
  return items.text();
}

}  // namespace cuboct
