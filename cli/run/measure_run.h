// SPDX-License-Identifier: MIT
// A measure of the frames of a run: of a directory that a run left, or of states at hand.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "cli/command.h"
#include "model/analysis/measurement.h"
#include "model/trace/trace.h"

namespace cuboct {

struct MeasureAsked {
  std::string name;    // of measure_names()
  std::string frames;  // as chosen_frames takes them; empty: usual_frames()
  MeasureChoice choice;
};

using KeptFrame = std::variant<const State*, const RealFrame*>;
// A frame that was measured, and what the measure says of each particle of it.
using SeeParticles =
    std::function<void(const KeptFrame& frame, const Snapshot& now, const MeasuredParticles& particles)>;

// s, from the time of a trace's velocities to that of its positions.
double velocities_late(const Trace& trace, double dt);
// Whether positions stand in the periodic box: integers and cells wrap them, whichever frames the trace has.
bool stands_in_box(const Trace& trace);

// The frames of a run's trace. InputError where it kept none.
Measured measure_trace(const Loaded& loaded, const Trace& trace, const MeasureAsked& asked,
                       const SeeParticles& see = {});
// The same of snapshots, ascending in step: `snapshot` makes the one of number k.
Measured measure_snapshots(
    const Scene& scene, const std::vector<uint64_t>& steps, const std::function<Snapshot(size_t k)>& snapshot,
    const MeasureAsked& asked,
    const std::function<void(size_t k, const Snapshot&, const MeasuredParticles&)>& see = {});

// A line for each row, as curves are written (model/trace/curves_csv.h): "r (m),g,...". `units`: not of
// reduced units.
std::string csv_of(const Measured& measured, bool units);
std::string json_of(const std::string& name, const Measured& measured, bool units);

// m or m^3 of an option such as "3 angstrom"; of a scene in reduced units a plain number.
double size_of(const std::string& option, const std::string& text, bool volume, bool reduced);

}  // namespace cuboct
