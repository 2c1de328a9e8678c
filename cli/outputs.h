// SPDX-License-Identifier: MIT
// The files of a run's directory.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "model/frames.h"
#include "model/raster.h"
#include "model/strain.h"
#include "model/trace.h"
#include "model/trace_head.h"

namespace cuboct {

// Axis along which strain is drawn: that of the first stress-strain probe, else the body's longest.
int strain_axis(const Scene& scene);

// Strain against `initial`, over the nearest neighbours.
StrainMeter strain_meter(const Scene& scene, const std::vector<Vec3>& initial);

// Frames in real units, with each particle's axial strain against the initial state.
std::vector<Frame> real_frames(const Loaded& loaded, const std::vector<State>& states);
FrameStyle frame_style(const Scene& scene);

// What the trace of such a run says of itself. References to `loaded`.
// `real`: of a run in real numbers, of which the plan says nothing.
TraceHead head_of(const Loaded& loaded, bool real, bool si);

// `across`: pixels along the body (raster_grid).
Rasters rasters_of(const Scene& scene, const std::vector<Frame>& frames, uint32_t across);

// What a report needs to find its way back: run.toml in the directory, its paths relative to the directory.
struct RunRecord {
  std::string scene, arch, engine;
};
void write_record(const std::string& directory, const RunRecord& record);
// Paths as they are to be opened now. InputError where the directory holds no run.
RunRecord read_record(const std::string& directory);

// Throws InputError where the run's files could not be written.
void prepare_directory(const std::string& directory);

}  // namespace cuboct
