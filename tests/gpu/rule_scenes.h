// SPDX-License-Identifier: MIT
// The scenes of rules of text that ship, as an engine in real numbers begins them.
#pragma once

#include <algorithm>
#include <string>

#include "model/rules/rounds_rule.h"
#include "model/run/start.h"

namespace cuboct::test {

// Of several stages the first.
inline Scene rule_scene(const std::string& name) {
  const std::string file = CUBOCT_SOURCE_DIR "/scenes/rules/" + name + ".toml";
  const std::vector<StageName> stages = stages_of(file);
  return read_scene(file, {.stage = stages.empty() ? "" : stages.front().name});
}

inline Body begin_of(const Scene& scene) {
  Body body = with_bonds(scene.rule, scene.body, scene.body);
  if (std::ranges::any_of(scene.rule.types, &ParticleType::pd)) body.u.assign(body.size(), Vec3::Zero());
  return body;
}

}  // namespace cuboct::test
