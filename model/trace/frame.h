// SPDX-License-Identifier: MIT
// One moment of a run for the viewers of the field, and the one table of what they see of each particle.
// Every format is written from it: docs/reference/frames.md. Real units: m, s, m/s.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/base/tensor.h"
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
  std::optional<Periodic> box{};               // where it is another one than the style's
  std::vector<std::vector<double>> own{};      // [FrameStyle::own][particle x its numbers]; empty: not known
};

struct FrameType {
  std::string material, constraint{};  // names; no constraint: empty
  std::string species = "X";           // a chemical symbol, "X": none
  double mass = 0;                     // kg
};

// A quantity that each particle has once, in numbers side by side.
struct FrameField {
  using Value = std::function<double(const Frame&, size_t particle, size_t number)>;

  std::string name;
  std::string unit;                       // "m/s"; "1" of a pure number
  std::vector<std::string> components{};  // "xx", ...; of a scalar none
  bool whole = false;                     // counts
  Value value{};

  size_t numbers() const { return components.empty() ? 1 : components.size(); }
};

struct FrameStyle {
  Periodic periodic;
  double radius = 0;              // m, of a drawn particle: half the pitch
  bool reduced = false;           // units of the scene: no metres, no seconds
  std::vector<FrameType> types;   // by type index
  std::vector<FrameField> own{};  // of the scene's rule, without values: those of Frame::own
};

// Of the name of a type, "material" or "material/constraint". `element`: of the atoms, where the rule knows.
FrameType frame_type(const std::string& name, double mass, const std::string& element = {});

// Velocity, radius, strains, broken bonds, and the rule's own fields, in the order of all files. Position, id
// and type are each format's own.
std::vector<FrameField> frame_fields(const FrameStyle& style);
// The unit as files tell it: "reduced" for what has one in a scene of reduced units.
std::string unit_text(const FrameStyle& style, const std::string& unit);

// The numbers "x", "y", "z" of a vector. Those of Frame::tensor are kTensorNames.
extern const std::vector<std::string> kVectorNames;

struct FrameBox {
  Vec3 lower, extent;  // m
};
// An axis without a period has the extent of the frame.
FrameBox box_of(const Frame& frame, const FrameStyle& style);

}  // namespace cuboct
