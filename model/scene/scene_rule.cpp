// SPDX-License-Identifier: MIT
// [rule] of a scene: a rule of several rounds in the place of [law].
#include <fmt/format.h>

#include "model/scene/scene_parts.h"

namespace cuboct {
namespace {

// What a rule of rounds has not, or not yet: before the body is read, which asks the pair law for it.
void refuse_pairs(const ConfigTable& root) {
  if (const auto symmetry = root.find("symmetry"))
    symmetry->fail("planes of symmetry serve the pair law alone", "a whole body, with constraints");
  if (const auto damping = root.find("damping"))
    damping->fail("damping by pairs serves the pair law alone",
                  "static = { } in [run] brings a body to rest without it");
  if (root.has("bond"))
    root.at("bond").fail("[[bond]] serves the pair law alone", "a rule of text with 'core' is one");
}

RuleChoice pair_law_or_rounds(const ConfigValue& value, RuleChoice choice, PackingChoice* packing) {
  if (!choice.law || packing == nullptr) return choice;
  relax_pitch(value, *choice.law, *packing);
  check_at_pitch(value, *choice.law, packing->fcc.pitch, false);
  return choice;
}

}  // namespace

void check_rounds_body(const ConfigTable& root, const Scene& scene) {
  for (const auto& row : scene.rule.strength)
    for (const double strength : row)
      if (strength != 1) root.fail("the materials' 'strength' serves the pair law alone");
  for (const ParticleType& type : scene.rule.types)
    if (type.pd && !(type.kp > 0)) root.fail(fmt::format("constraint of '{}' needs 'kp'", type.name));
}

std::optional<RuleChoice> read_rule(const ConfigTable& root, PackingChoice* packing, CrystalChoice* crystal) {
  const auto value = root.find("rule");
  if (!value) {
    if (crystal != nullptr) crystal->table.fail("a crystal of atoms needs [rule]", "kind = \"tersoff\"");
    return std::nullopt;
  }
  root.not_both("law", "rule");
  const auto no_law = [&] {
    refuse_pairs(root);
    if (packing != nullptr && packing->fcc.pitch == 0)
      value->fail("a rule of rounds needs a given pitch, not \"relaxed\"");
  };
  const std::optional<ConfigTable> table = value->is_table() ? root.table_at("rule") : std::nullopt;
  if (table) table->record_as("rule");
  if (!table || !table->has("kind")) {
    if (crystal != nullptr)
      crystal->table.fail("a crystal of atoms serves kind = \"tersoff\" alone",
                          "[packing] has the particles of other rules");
    if (table && !table->has("file") && !table->has("reach")) table->at("kind");
    const auto regions = root.table_at("regions");
    const std::vector<std::string> names = regions ? regions->names() : std::vector<std::string>();
    return pair_law_or_rounds(*value, read_program_rule(*value, packing, names, no_law), packing);
  }
  no_law();
  const ConfigValue kind = table->at("kind");
  if (kind.choice("rule", {"lps", "tersoff"}) == 0) {
    if (crystal != nullptr)
      crystal->table.fail("a crystal of atoms serves kind = \"tersoff\" alone",
                          "[packing] has the points of a solid");
    return read_lps_rule(*table, packing);
  }
  if (packing != nullptr)
    kind.fail("atoms of \"tersoff\" stand in a [crystal], not in a [packing]",
              "[crystal] with lattice = \"graphene\" or \"diamond\"");
  return read_tersoff_rule(*table, crystal);
}

}  // namespace cuboct
