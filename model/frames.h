// SPDX-License-Identifier: MIT
// Frames for the viewers of the field: extended XYZ for OVITO, VTK XML for ParaView. Real units: m, s, m/s.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/rule.h"

namespace cuboct {

// One moment, ready to draw. The index is the particle's id.
struct Frame {
  uint64_t step = 0;
  double time = 0;             // s
  std::vector<Vec3> x, v;      // m, m/s
  std::vector<uint8_t> type;   // index into the rule's types
  std::vector<double> strain;  // axial elongation, 1 (strain.h)
};

struct FrameStyle {
  Periodic periodic;
  double radius = 0;               // m, of a drawn particle: half the pitch
  std::vector<std::string> types;  // names, by type index
};

// Frames one after another: null after the last. A frame need live only until the next is asked for, so that
// millions of particles are held once. Asked from the first again where it is called with `restart`.
using FrameSource = std::function<const Frame*(bool restart)>;

// All frames in one file, one after another; each has a Lattice, Properties and Time entry as OVITO reads
// them: id, species, pos (m), velo (m/s), Radius (m), AxialStrain. An axis without a period gets the extent
// of all frames, so the source is walked twice.
void write_extended_xyz(const std::string& path, const FrameSource& frames, const FrameStyle& style);
void write_extended_xyz(const std::string& path, const std::vector<Frame>& frames, const FrameStyle& style);

// <stem>.pvd lists <stem>_000000.vtp, ... (left-overs of a longer run are removed): one file per frame with
// velocity, type, id, strain and radius per point. Positions are doubles, the rest floats.
void write_vtk(const std::string& stem, const FrameSource& frames, const FrameStyle& style);
void write_vtk(const std::string& stem, const std::vector<Frame>& frames, const FrameStyle& style);

}  // namespace cuboct
