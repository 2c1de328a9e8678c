// SPDX-License-Identifier: MIT
// A rule of text on the gpu engine in real numbers against the reference in doubles, within the bounds of
// model/program/program_errors.h.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cli/run/told.h"
#include "model/scene/scene.h"
#include "model/trace/trace.h"

namespace cuboct {

class TextComparison {
 public:
  // Runs the reference as far as bounds of positions tell something, and no more than so many steps. Keeps a
  // reference to the scene.
  TextComparison(const Scene& scene, bool floats, uint64_t steps);
  ~TextComparison();

  uint64_t step() const;  // how far that was
  // Of the engine's first and last state and that one: forces and fields at the start; positions and fields
  // after the short run; forces and fields of the last state, where frames have all that the rule keeps from
  // step to step. Whether all are within their bounds.
  bool compare(Told& told, const std::vector<RealFrame>& frames) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace cuboct
