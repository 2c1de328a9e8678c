// SPDX-License-Identifier: MIT
// Frames as the page of a run reads them: blocks of numbers of equal size, little-endian, particle by
// particle. The page's end of it is cli/view/web/blocks.js and words.js; docs/reference/view.md has the
// layout.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/contract/state.h"
#include "model/trace/frame.h"
#include "model/trace/trace.h"
#include "model/trace/trace_head.h"

namespace cuboct {

struct ViewBlock {
  std::string name;
  std::string number;                     // of each: "u8", "u16", "f32", "f64", or "words"
  uint32_t numbers = 1;                   // of a particle
  std::string unit = "1";                 // as FrameField::unit; reduced units have "1"
  std::vector<std::string> components{};  // their names; of a scalar none
  bool field = true;                      // colours can be of it
  size_t width() const;                   // bytes of a number
  size_t row() const { return numbers * width(); }
};

struct ViewFrame {
  uint64_t step = 0;
  double time = 0;                  // s
  Vec3 lower, extent;               // m, of the particles that have a place
  std::vector<std::string> blocks;  // in the order of ViewFrames::blocks()
  std::vector<Curve> read{};        // of a run that goes: what probes have read since the frame before
  std::string json() const;         // all but the blocks
};

// Of one run. All frames have the same particles.
class ViewFrames {
 public:
  // Places in 16 bits of the frame's extent, 65535 where there is none; types; exact positions and
  // velocities; then fields.
  static constexpr size_t kPlaces = 0, kTypes = 1, kExact = 2, kFields = 3;

  // Keeps a reference to `head`. `most`: a part of the particles is taken where there are more, spread evenly
  // over the ids.
  ViewFrames(const TraceHead& head, const FrameStyle& style, size_t particles, size_t most);

  const std::vector<ViewBlock>& blocks() const { return blocks_; }
  size_t shown() const { return shown_; }
  // Of the particle at a place in the blocks.
  size_t id(size_t place) const { return place * particles_ / shown_; }

  // `state`: of the fixed rule, whose words are the exact numbers; null in a run of real numbers.
  ViewFrame make(const Frame& frame, const State* state) const;
  // The same without blocks.
  ViewFrame bounds(const Frame& frame) const;

  // What makes a picture of the blocks, as a JSON object.
  std::string head_json(const std::string& engine) const;

 private:
  std::string places(const Frame& frame, const ViewFrame& box) const;
  std::string exact(const Frame& frame, const State* state) const;
  std::string field(const Frame& frame, const FrameField& field) const;

  const TraceHead& head_;
  FrameStyle style_;
  std::vector<FrameField> fields_;
  std::vector<ViewBlock> blocks_;
  size_t particles_, shown_;
};

}  // namespace cuboct
