// SPDX-License-Identifier: MIT
// The files of a run's directory.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "model/analysis/strain.h"
#include "model/run/engine.h"
#include "model/trace/frame.h"
#include "model/trace/trace.h"
#include "model/trace/trace_head.h"

namespace cuboct {

// Axis along which strain is drawn: that of the first stress-strain probe, else the body's longest.
int strain_axis(const Scene& scene);

// Strain against `initial`, over the nearest neighbours.
StrainMeter strain_meter(const Scene& scene, const std::vector<Vec3>& initial);

FrameStyle frame_style(const Scene& scene);

// What the trace of such a run says of itself. References to `loaded`.
// `real`: of a run in real numbers, of which the plan says nothing.
TraceHead head_of(const Loaded& loaded, bool real, bool si);

// The last state of a run, as another can begin with it: DIR/trace.h5, which load_scene reads. `rest`:
// without frames.
void leave_state(const std::string& directory, const TraceHead& head, const RunState& last,
                 const Trace& rest);

// A state in real units, without strains.
Frame frame_of(const Loaded& loaded, const State& state);
Frame frame_of(const Loaded& loaded, const RealFrame& real);  // types the scene's

// Frames in real units, with each particle's axial strain against the initial state.
class FrameMaker {
 public:
  // `whole`: with strain tensors and broken bonds, which pictures do without.
  FrameMaker(const Loaded& loaded, bool whole);
  Frame make(const State& state) const;
  Frame make(const RealFrame& frame) const;

 private:
  void measure(Frame& frame, bool fixed) const;
  // Against what the engine begins with: positions of the fixed rule, or the scene's own.
  StrainMeter& meter(bool fixed) const;
  const StrainMeter& meter(bool fixed, const Frame& frame) const;  // in the frame's box

  const Loaded& loaded_;
  int axis_;
  bool whole_;
  mutable std::optional<StrainMeter> fixed_, real_;
};

// What a report needs to find its way back, and a run to know whose directory it is: run.toml in the
// directory, its paths relative to the directory.
struct RunRecord {
  std::string scene, arch, engine;
  std::string state =
      "finished";               // or "running" (or killed), "interrupted", "stopped" (a fault), "incomplete"
  std::string stage{}, from{};  // model/run/start.h
  bool reached = false;         // `until` ended it
};
void write_record(const std::string& directory, const RunRecord& record);
// Paths as they are to be opened now. InputError where the directory holds no run.
RunRecord read_record(const std::string& directory);
// The trace of the directory's run. InputError where it did not end.
Trace read_run(const std::string& directory, const RunRecord& record);
// What it was a run of. InputError where the scene gives another plan now.
Loaded scene_of_run(const std::string& directory, const RunRecord& record, const Trace& trace);
// Whether a directory's run has come to its end, and all that it left is there.
bool is_over(const RunRecord& record);

}  // namespace cuboct
