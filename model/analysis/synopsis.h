// SPDX-License-Identifier: MIT
// A scene and its run in a few lines for people: body, waves, time, strain. Lengths and times are three
// digits in the unit that suits them, in reduced units plain numbers.
#pragma once

#include <string>
#include <vector>

#include "model/scene/scene.h"

namespace cuboct {

// m, of the box around the particles' centres.
Vec3 body_size(const Scene& scene);

struct SynopsisLine {
  std::string name, text;
  std::string note{};
};

// From the body to `until`, those alone that the scene has:
//   body      extents (of the box along axes that repeat), number, mass and distance of the particles
//   mesh      of each file: triangles, area, volume; then "packed", the volume that the particles fill
//   waves     speed of sound, and the time L / c from end to end of the longest side L
//   run       steps of dt = duration T, and its T c / L crossings
//   loading   of a static scene
//   step      dt over its limit
//   strain    as model/analysis/motion.h estimates it
//   until     what ends the run early
std::vector<SynopsisLine> synopsis_of(const Scene& scene);

// Of a stage: "400 steps of 48.2 ns = 19.3 us, until grip.force is below 0.1, damped".
std::string stage_synopsis(const Scene& scene);

}  // namespace cuboct
