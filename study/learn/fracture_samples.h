// SPDX-License-Identifier: MIT
// Sheets of atoms with a slit whose crack grows, seen on points (data sets III and IV of section 5.1 of the
// paper). SI units.
#pragma once

#include "study/learn/samples.h"

namespace cuboct::learn {

// What the points of a grid had at a frame.
struct Frame {
  std::vector<Vec3> u, acceleration, b;  // m, m/s^2, N/m^3
};
// Atoms at a frame, for pictures. m
struct AtomFrame {
  int frame = 0;
  std::vector<Vec3> x, u;
};
struct FractureSample {
  std::vector<std::vector<double>> density;  // [grid][point], before the load: kg/m^3
  std::vector<std::vector<Vec3>> velocity;   // [grid][point], m/s: that it begins with
  std::vector<std::vector<Frame>> frames;    // [grid][frame], the first at rest
  std::vector<AtomFrame> atoms;
  double seconds = 0;  // of a core, that the atoms' motion took
};

// Training: pulled apart at its edges. Test: pushed by a pulse, with all edges free.
enum class FractureLoad : uint8_t { pulled, pushed };

// The grids of a study: that of the training, a finer and a coarser one.
std::vector<Grid> fracture_grids(const LearnStudy& study, const AtomCell& sheet);

// The sheet with a slit from its lower edge. `see` is called with each frame that is done; it may throw to
// end the run. std::runtime_error where the sheet with its slit comes to no rest.
FractureSample fracture(const LearnStudy& study, const AtomCell& sheet, FractureLoad load,
                        const std::function<void(int)>& see);

}  // namespace cuboct::learn
