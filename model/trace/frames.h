// SPDX-License-Identifier: MIT
// Frames as text: extended XYZ for OVITO and ASE, LAMMPS dumps for LAMMPS and OVITO.
// docs/reference/frames.md.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "model/base/output.h"
#include "model/trace/frame.h"

namespace cuboct {

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

struct XyzForm {
  bool packed = false;
  // In ASE's units: angstrom, u, and momenta in sqrt(u eV) in the place of velocities. Not of reduced units.
  bool ase = false;
  // All digits of positions, velocities and box, and of the fields velocity alone: a state to begin with.
  bool exact = false;
};

// All frames in one file, one after another. `Properties` names the columns, `units` their units.
class XyzWriter {
 public:
  XyzWriter(const std::string& path, const FrameStyle& style, const XyzForm& form = {});  // empty then
  // Throws InputError where the disk has no room: the frame is then left out.
  void add(const Frame& frame);

 private:
  FrameStyle style_;
  std::vector<FrameField> fields_;
  std::vector<std::string> species_, words_;  // by type: the first column, and those that do not change
  std::string head_;                          // Properties and units
  double length_ = 1;                         // of the file's unit in a metre
  bool exact_;
  FrameText file_;
};

// A LAMMPS dump of all frames, as gzip. `id` counts from 1, as LAMMPS has it; cuboct's own is one less. So
// does `type`.
class LammpsWriter {
 public:
  LammpsWriter(const std::string& path, const FrameStyle& style);
  // Throws InputError where the disk has no room: the frame is then left out.
  void add(const Frame& frame);

 private:
  FrameStyle style_;
  std::vector<FrameField> fields_;
  std::string columns_;
  FrameText file_;
};

}  // namespace cuboct
