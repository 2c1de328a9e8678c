// SPDX-License-Identifier: MIT
// Runs that begin where another one ended. The scene packs its particles as ever, so that regions,
// displacements and strains count from the packing; then positions, velocities and what bonds keep become
// those of the state that was left.
#pragma once

#include <string>

#include "model/contract/fixed_rule.h"
#include "model/scene/scene.h"

namespace cuboct {

struct StartChoice {
  std::string stage;        // of a scene with stages
  std::string from;         // directory of a run, relative to here; empty: what the scene's [start] says
  bool looks_only = false;  // a later stage may do without `from`, and then begins with the packing
};

// Throws InputError where scene or state cannot be read, or the state is that of other particles. A stage but
// the first begins at `from`.
Scene load_scene(const std::string& path, const StartChoice& choice);
// The same for text in memory; `path` stands in messages, and what [start] names is counted from its
// directory.
Scene load_scene(const std::string& text, const std::string& path, const StartChoice& choice);
// stages_of() such a text.
std::vector<StageName> stages_in(const std::string& text, const std::string& path);

// The end of a run in `directory` becomes the beginning of the scene.
void begin_at(Scene& scene, const std::string& directory);

// Of a scene that begin_at changed: from where, and what became of the numbers. `rule`: null for engines in
// real numbers.
std::string start_text(const Scene& scene, const FixedRule* rule, const Vec3& origin);

}  // namespace cuboct
