// SPDX-License-Identifier: MIT
#include "cli/run/plan_text.h"

#include "model/rules/rounds_rule.h"

namespace cuboct {

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
