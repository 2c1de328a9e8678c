// SPDX-License-Identifier: MIT
// Frames for ParaView and other programs upon VTK. docs/reference/frames.md.
#pragma once

#include <string>
#include <vector>

#include "model/base/output.h"
#include "model/trace/frame.h"

namespace cuboct {

// <stem>.pvd lists <stem>_000000.vtp, ...: one file per frame, packed by zlib. Positions are doubles, other
// real numbers floats.
class VtkWriter {
 public:
  VtkWriter(const std::string& stem, const FrameStyle& style);
  // Throws InputError where the disk has no room: the frame is then left out.
  void add(const Frame& frame);

 private:
  std::string stem_;
  FrameStyle style_;
  std::vector<FrameField> fields_;
  GrowingFile list_;
  size_t count_ = 0;
};

// The files of an earlier run.
void remove_vtk(const std::string& stem);

}  // namespace cuboct
