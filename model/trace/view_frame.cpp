// SPDX-License-Identifier: MIT
#include "model/trace/view_frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "model/base/json.h"
#include "model/trace/curve_readings.h"

namespace cuboct {
namespace {

static_assert(std::endian::native == std::endian::little, "blocks are little-endian");

constexpr double kSteps = 65534;  // of a place along an axis
constexpr uint16_t kNowhere = 65535;

template <typename T>
void put(char*& to, T value) {
  std::memcpy(to, &value, sizeof value);
  to += sizeof value;
}

std::string vector_json(const Vec3& v) { return json(std::vector<double>{v[0], v[1], v[2]}); }

// Whether the frame has what the field is made of: a frame for pictures alone has no tensors, an engine may
// show no fields.
bool is_there(const Frame& frame, const FrameField& field) {
  if (field.name == "axial_strain") return !frame.strain.empty();
  if (field.name == "strain") return !frame.tensor.empty();
  if (field.name == "broken_bonds") return !frame.broken.empty();
  return true;
}

}  // namespace

size_t ViewBlock::width() const {
  if (number == "u8") return 1;
  if (number == "u16") return 2;
  return number == "f32" ? 4 : 8;
}

std::string ViewFrame::json() const {
  std::string text = json_object({{"step", std::to_string(step)},
                                  {"time", cuboct::json(time)},
                                  {"lower", vector_json(lower)},
                                  {"extent", vector_json(extent)}});
  if (read.empty()) return text;
  text.back() = ',';
  return text + "\"read\":" + json_array(read, curve_json) + "}";
}

ViewFrames::ViewFrames(const TraceHead& head, const FrameStyle& style, size_t particles, size_t most)
    : head_(head),
      style_(style),
      fields_(frame_fields(style)),
      particles_(particles),
      shown_(std::max<size_t>(1, std::min(particles, most))) {
  std::erase_if(fields_,
                [](const FrameField& field) { return field.name == "radius"; });  // one number for all
  blocks_ = {{"place", "u16", 3, "1", {}, false},
             {"type", "u8", 1, "1", {}, false},
             // Three words of 64 bits of x, three of v, three of 32 bits of the cell, and 32 bits of nothing.
             {"exact", head.rule ? "words" : "f64", head.rule ? 8U : 6U, "1", {}, false}};
  for (const FrameField& field : fields_)
    blocks_.push_back({field.name, "f32", static_cast<uint32_t>(field.numbers()),
                       style.reduced ? "1" : field.unit, field.components});
}

ViewFrame ViewFrames::bounds(const Frame& frame) const {
  ViewFrame box{frame.step, frame.time, Vec3::Zero(), Vec3::Zero(), {}};
  Vec3 upper = Vec3::Zero();
  bool any = false;
  for (const Vec3& x : frame.x) {
    if (!x.allFinite()) continue;
    box.lower = any ? Vec3(box.lower.cwiseMin(x)) : x;
    upper = any ? Vec3(upper.cwiseMax(x)) : x;
    any = true;
  }
  box.extent = upper - box.lower;
  return box;
}

std::string ViewFrames::places(const Frame& frame, const ViewFrame& box) const {
  Vec3 scale;
  for (int axis = 0; axis < 3; ++axis) scale[axis] = box.extent[axis] > 0 ? kSteps / box.extent[axis] : 0;
  std::string out(shown_ * 6, '\0');
  char* to = out.data();
  for (size_t k = 0; k < shown_; ++k) {
    const Vec3& x = frame.x[id(k)];
    const bool placed = x.allFinite();
    for (int axis = 0; axis < 3; ++axis)
      put(to,
          placed ? static_cast<uint16_t>(std::lround((x[axis] - box.lower[axis]) * scale[axis])) : kNowhere);
  }
  return out;
}

std::string ViewFrames::exact(const Frame& frame, const State* state) const {
  std::string out(shown_ * blocks_[kExact].row(), '\0');
  char* to = out.data();
  for (size_t k = 0; k < shown_; ++k) {
    const size_t i = id(k);
    if (!head_.rule) {
      for (int axis = 0; axis < 3; ++axis) put(to, frame.x[i][axis]);
      for (int axis = 0; axis < 3; ++axis) put(to, frame.v[i][axis]);
      continue;
    }
    const Particle& particle = state->particles[i];
    for (const int64_t word : particle.x) put(to, word);
    for (const int64_t word : particle.v) put(to, word);
    for (const int32_t cell : head_.lattice->cell(particle.cell)) put(to, cell);
    put(to, int32_t{0});
  }
  return out;
}

std::string ViewFrames::field(const Frame& frame, const FrameField& field) const {
  const size_t numbers = field.numbers();
  const bool there = is_there(frame, field);
  std::string out(shown_ * numbers * 4, '\0');
  char* to = out.data();
  for (size_t k = 0; k < shown_; ++k)
    for (size_t c = 0; c < numbers; ++c)
      put(to,
          there ? static_cast<float>(field.value(frame, id(k), c)) : std::numeric_limits<float>::quiet_NaN());
  return out;
}

ViewFrame ViewFrames::make(const Frame& frame, const State* state) const {
  ViewFrame out = bounds(frame);
  out.blocks.push_back(places(frame, out));
  std::string types(shown_, '\0');
  for (size_t k = 0; k < shown_; ++k) types[k] = static_cast<char>(frame.type[id(k)]);
  out.blocks.push_back(std::move(types));
  out.blocks.push_back(exact(frame, state));
  for (const FrameField& one : fields_) out.blocks.push_back(field(frame, one));
  return out;
}

std::string ViewFrames::head_json(const std::string& engine) const {
  const Scene& scene = head_.scene;
  const auto type_json = [](const FrameType& type) {
    return json_object({{"material", json(type.material)},
                        {"constraint", json(type.constraint)},
                        {"mass", json(type.mass)}});
  };
  const auto block_json = [](const ViewBlock& block) {
    return json_object({{"name", json(block.name)},
                        {"number", json(block.number)},
                        {"numbers", std::to_string(block.numbers)},
                        {"unit", json(block.unit)},
                        {"components", json(block.components)},
                        {"field", json(block.field)}});
  };
  // What the eye should meet first: how far it is strained where that is measured, else how fast it moves.
  const bool strained = std::ranges::any_of(
      scene.probes, [](const Probe& probe) { return probe.kind == Probe::Kind::stress_strain; });
  std::string deform = "null";  // BoxDeformation
  if (scene.deform)
    deform = json_object({{"origin", vector_json(scene.deform->packed.origin)},
                          {"extent", vector_json(scene.deform->packed.extent)},
                          {"strain", vector_json(scene.deform->strain)},
                          {"per_step", vector_json(scene.deform->per_step)}});
  std::string words = "null";
  if (const FixedRule* rule = head_.rule) {
    const CellEdges edges = rule->edges();
    words = json_object({{"fraction", std::to_string(rule->widths.velocity_frac())},
                         {"velocity_bits", std::to_string(rule->widths.velocity_bits)},
                         {"edge", vector_json(Vec3(edges[0], edges[1], edges[2]))},
                         {"origin", vector_json(head_.origin)}});
  }
  return json_object({{"title", json(scene.title.empty() ? scene.path : scene.title)},
                      {"engine", json(engine)},
                      {"particles", std::to_string(particles_)},
                      {"shown", std::to_string(shown_)},
                      {"dt", json(scene.rule.dt)},
                      {"static", json(scene.loading.has_value())},
                      {"reduced", json(style_.reduced)},
                      {"radius", json(style_.radius)},
                      {"periodic", json_object({{"origin", vector_json(style_.periodic.origin)},
                                                {"extent", vector_json(style_.periodic.extent)}})},
                      {"deform", deform},
                      {"types", json_array(style_.types, type_json)},
                      {"blocks", json_array(blocks_, block_json)},
                      {"type", std::to_string(kTypes)},
                      {"exact", std::to_string(kExact)},
                      {"colour", json(std::string(strained ? "axial strain" : "speed"))},
                      {"words", words}});
}

}  // namespace cuboct
