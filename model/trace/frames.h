// SPDX-License-Identifier: MIT
// Frames for the viewers of the field: extended XYZ for OVITO, VTK XML for ParaView. Real units: m, s, m/s.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/base/output.h"
#include "model/contract/rule.h"

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

// All frames in one file, one after another; each has a Lattice, Properties and Time entry as OVITO reads
// them: id, species, pos (m), velo (m/s), Radius (m), AxialStrain. An axis without a period has the extent of
// the frame.
class XyzWriter {
 public:
  XyzWriter(const std::string& path, const FrameStyle& style);  // the file is empty then
  // Throws InputError where the disk has no room: the frame is then left out.
  void add(const Frame& frame);

 private:
  FrameStyle style_;
  std::vector<std::string> names_;
  GrowingFile file_;
};

// <stem>.pvd lists <stem>_000000.vtp, ...: one file per frame with velocity, type, id, strain and radius per
// point. Positions are doubles, the rest floats.
class VtkWriter {
 public:
  VtkWriter(const std::string& stem, const FrameStyle& style);
  // Throws InputError where the disk has no room: the frame is then left out.
  void add(const Frame& frame);

 private:
  std::string stem_;
  FrameStyle style_;
  GrowingFile list_;
  size_t count_ = 0;
};

// The files of an earlier run.
void remove_vtk(const std::string& stem);

}  // namespace cuboct
