// SPDX-License-Identifier: MIT
// Frames for the viewers of the field: extended XYZ and LAMMPS dumps for OVITO, VTK XML for ParaView. Real
// units: m, s, m/s.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/base/output.h"
#include "model/contract/rule.h"

namespace cuboct {

// One moment, ready to draw. The index is the particle's id.
struct Frame {
  uint64_t step = 0;
  double time = 0;                             // s
  std::vector<Vec3> x, v;                      // m, m/s
  std::vector<uint8_t> type;                   // index into the rule's types
  std::vector<double> strain{};                // axial elongation, 1 (strain.h)
  std::vector<std::array<float, 6>> tensor{};  // Green-Lagrange strain: xx, yy, zz, xy, xz, yz
  std::vector<uint32_t> broken{};              // initial neighbours that are out of reach
};

struct FrameStyle {
  Periodic periodic;
  double radius = 0;               // m, of a drawn particle: half the pitch
  std::vector<std::string> types;  // names, by type index
};

// A text that grows frame by frame, plain or as gzip: a member of its own per commit, so that what is there
// can be read while the run goes.
class FrameText {
 public:
  FrameText(const std::string& path, bool packed);
  ~FrameText();
  void write(const char* text, size_t size);
  void commit();

 private:
  struct Packer;
  GrowingFile file_;
  std::unique_ptr<Packer> packer_;  // null: plain
};

// All frames in one file, one after another; each has a Lattice, Properties and Time entry as OVITO reads
// them: id, species, pos (m), velo (m/s), Radius (m), AxialStrain, StrainTensor (six components),
// BrokenBonds. An axis without a period has the extent of the frame.
class XyzWriter {
 public:
  XyzWriter(const std::string& path, const FrameStyle& style, bool packed = false);  // the file is empty then
  // Throws InputError where the disk has no room: the frame is then left out.
  void add(const Frame& frame);

 private:
  FrameStyle style_;
  std::vector<std::string> names_;
  FrameText file_;
};

// A LAMMPS dump of all frames, as gzip, with the columns' names that OVITO knows. `id` is cuboct's, from 0;
// `type` counts from 1.
class LammpsWriter {
 public:
  LammpsWriter(const std::string& path, const FrameStyle& style);
  // Throws InputError where the disk has no room: the frame is then left out.
  void add(const Frame& frame);

 private:
  FrameStyle style_;
  FrameText file_;
};

// <stem>.pvd lists <stem>_000000.vtp, ...: one file per frame with velocity, type, id, strain, broken bonds
// and radius per point, packed by zlib. Positions are doubles, the rest floats.
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
