// SPDX-License-Identifier: MIT
// The frames that a report shows, of a run in integers or in real numbers.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/run/outputs.h"
#include "model/trace/trace.h"

namespace cuboct {

// The frames of a trace. Keeps the references.
class Shots {
 public:
  // Throws InputError where frames are not of the scene's particles; `path` is the trace's, for the message.
  Shots(const Loaded& loaded, const Trace& trace, const std::string& path);
  size_t size() const { return real_ ? trace_.bodies.size() : trace_.frames.size(); }
  uint64_t step(size_t k) const { return real_ ? trace_.bodies[k].step : trace_.frames[k].step; }
  Frame frame(size_t k) const { return made(k, axial_); }        // with axial strain
  Frame whole_frame(size_t k) const { return made(k, whole_); }  // with all that a frame has
  bool real() const { return real_; }
  const State* state(size_t k) const { return real_ ? nullptr : &trace_.frames[k]; }
  // The first frame in which an initial neighbour is out of the law's reach, by halving: bonds that broke
  // stay broken, as a rule.
  std::optional<size_t> crack_onset() const;

 private:
  Frame made(size_t k, const FrameMaker& maker) const;

  const Trace& trace_;
  bool real_;
  FrameMaker axial_, whole_;
};

// Frames under one another, coloured by axial strain up to `limit` (absent: the 90th percentile of these
// frames), above a bar. PNG bytes. `frame_of` is asked for each frame twice, as there may be millions of
// particles. Particles without a finite position are left out.
std::string draw_frames(const Scene& scene, const std::vector<std::string>& labels,
                        const std::function<Frame(size_t)>& frame_of, std::optional<double> limit = {});

}  // namespace cuboct
