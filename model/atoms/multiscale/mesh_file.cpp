// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "model/base/error.h"
#include "model/config/config.h"

namespace cuboct {
namespace {

constexpr double kSame = 1e-6;  // of the body's extent: vertices that near are one

// Numbers of the file one after the other, and the line that they stand in.
class Words {
 public:
  explicit Words(const std::string& path) : path_(path), text_(read_config_text(path)) {}

  // False at the end of the file.
  bool next_line(std::string& line) {
    if (at_ >= text_.size()) return false;
    const size_t end = std::min(text_.find('\n', at_), text_.size());
    line = text_.substr(at_, end - at_);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    at_ = end + 1, ++line_;
    return true;
  }
  double number() {
    skip_blanks();
    char* end = nullptr;
    const char* const begin = text_.c_str() + at_;
    const double value = std::strtod(begin, &end);
    if (end == begin || !std::isfinite(value)) fail("a number was expected");
    at_ += static_cast<size_t>(end - begin);
    return value;
  }
  uint64_t count(uint64_t most = uint64_t{1} << 32) {
    const double value = number();
    if (value < 0 || value != std::floor(value) || value > static_cast<double>(most))
      fail(fmt::format("{:g} is not a whole number from 0 to {}", value, most));
    return static_cast<uint64_t>(value);
  }
  // Of things that take two characters each at least.
  uint64_t things() { return count(text_.size() / 2); }
  int64_t tag() {
    const double value = number();
    if (value != std::floor(value) || std::abs(value) > 1e15)
      fail(fmt::format("{:g} is not a whole number", value));
    return static_cast<int64_t>(value);
  }
  int line() const { return line_; }
  [[noreturn]] void fail(const std::string& message) const { throw InputError(path_, line_, 1, message); }

 private:
  void skip_blanks() {
    for (; at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])); ++at_)
      line_ += text_[at_] == '\n';
  }

  std::string path_, text_;
  size_t at_ = 0;
  int line_ = 1;
};

// Of element types of Gmsh: how many nodes, and whether they have a volume. Types 1 to 15 and the
// second-order ones that it writes.
struct Kind {
  int nodes;
  bool solid;
};
std::optional<Kind> kind_of(uint64_t type) {
  static const std::map<uint64_t, Kind> kinds{
      {1, {2, false}},  {2, {3, false}},  {3, {4, false}},  {4, {4, true}},   {5, {8, true}},
      {6, {6, true}},   {7, {5, true}},   {8, {3, false}},  {9, {6, false}},  {10, {9, false}},
      {11, {10, true}}, {12, {27, true}}, {13, {18, true}}, {14, {14, true}}, {15, {1, false}},
      {16, {8, false}}, {17, {20, true}}, {18, {15, true}}, {19, {13, true}}};
  const auto found = kinds.find(type);
  return found == kinds.end() ? std::nullopt : std::optional(found->second);
}
constexpr uint64_t kTetrahedron = 4;

class GmshFile {
 public:
  GmshFile(const std::string& path, double unit) : words_(path), unit_(unit) {}

  ElementMesh read() {
    std::string line;
    while (words_.next_line(line)) {
      if (line == "$MeshFormat") read_format();
      if (line == "$Nodes") version_ < 4 ? read_nodes2() : read_nodes4();
      if (line == "$Elements") version_ < 4 ? read_elements2() : read_elements4();
    }
    if (version_ == 0) words_.fail("no $MeshFormat: this is no file of Gmsh");
    if (mesh_.elements.empty()) words_.fail("the file has no tetrahedra");
    number_grains();
    return std::move(mesh_);
  }
  const MeshLines& lines() const { return lines_; }

 private:
  void read_format() {
    version_ = words_.number();
    const uint64_t binary = words_.count();
    if (!(version_ >= 2 && version_ < 3) && !(version_ >= 4 && version_ < 5))
      words_.fail(fmt::format("MSH {:g}: formats 2 and 4 are read", version_));
    if (version_ == 4) words_.fail("MSH 4.0: write 4.1 or 2.2 (gmsh -format msh41)");
    if (binary != 0) words_.fail("the file is binary: write it as text (gmsh -bin 0)");
  }
  void need_format() const {
    if (version_ == 0) words_.fail("$MeshFormat does not come first");
  }

  void add_node(int64_t tag) {
    if (!node_.emplace(tag, static_cast<uint32_t>(mesh_.x.size())).second)
      words_.fail(fmt::format("node {} stands twice", tag));
    const double x = words_.number(), y = words_.number(), z = words_.number();
    mesh_.x.push_back(unit_ * Vec3(x, y, z));
    lines_.vertices.push_back(words_.line());
  }
  void read_nodes2() {
    need_format();
    for (uint64_t left = words_.things(); left > 0; --left) add_node(words_.tag());
  }
  void read_nodes4() {
    uint64_t blocks = words_.things();
    for (int skipped = 0; skipped < 3; ++skipped) words_.number();
    for (; blocks > 0; --blocks) {
      const uint64_t dimension = words_.count();
      words_.tag();
      const uint64_t parametric = words_.count();
      std::vector<int64_t> tags(words_.things());
      for (int64_t& tag : tags) tag = words_.tag();
      for (const int64_t tag : tags) {
        add_node(tag);
        if (parametric != 0)
          for (uint64_t k = 0; k < dimension; ++k) words_.number();
      }
    }
  }

  void add_element(int64_t tag, uint64_t type, int64_t entity) {
    const std::optional<Kind> kind = kind_of(type);
    if (!kind) words_.fail(fmt::format("element {} is of type {}, which is not known", tag, type));
    if (kind->solid && type != kTetrahedron)
      words_.fail(fmt::format("element {} is of type {}: elements are tetrahedra of four nodes", tag, type));
    std::array<ElementMesh::Corner, 4> corners{};
    for (int k = 0; k < kind->nodes; ++k) {
      const int64_t node = words_.tag();
      const auto found = node_.find(node);
      if (found == node_.end())
        words_.fail(fmt::format("element {} has node {}, which is not there", tag, node));
      if (kind->solid) corners[k].vertex = found->second;
    }
    if (!kind->solid) return;
    mesh_.elements.push_back(corners);
    lines_.elements.push_back(words_.line());
    entity_.push_back(entity);
  }
  void read_elements2() {
    need_format();
    for (uint64_t left = words_.things(); left > 0; --left) {
      const int64_t tag = words_.tag();
      const uint64_t type = words_.count(), tags = words_.count(100);
      int64_t entity = 0;
      for (uint64_t k = 0; k < tags; ++k) {
        const int64_t one = words_.tag();
        if (k == 1) entity = one;  // the first is the physical group, the second the elementary entity
      }
      add_element(tag, type, entity);
    }
  }
  void read_elements4() {
    uint64_t blocks = words_.things();
    for (int skipped = 0; skipped < 3; ++skipped) words_.number();
    for (; blocks > 0; --blocks) {
      words_.count();
      const int64_t entity = words_.tag();
      const uint64_t type = words_.count();
      for (uint64_t left = words_.things(); left > 0; --left) add_element(words_.tag(), type, entity);
    }
  }

  void number_grains() {
    std::map<int64_t, uint32_t> grain;
    for (const int64_t entity : entity_) grain[entity] = 0;
    uint32_t next = 0;
    for (auto& [entity, number] : grain) number = next++;
    for (const int64_t entity : entity_) mesh_.grain.push_back(grain[entity]);
  }

  Words words_;
  double unit_, version_ = 0;
  ElementMesh mesh_;
  MeshLines lines_;
  std::map<int64_t, uint32_t> node_;  // by tag
  std::vector<int64_t> entity_;       // of each element
};

struct Extent {
  double low, high;
};
Extent extent_of(const ElementMesh& mesh, int axis) {
  const auto less = [&](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; };
  return {std::ranges::min_element(mesh.x, less)->operator[](axis),
          std::ranges::max_element(mesh.x, less)->operator[](axis)};
}

// Vertices of the upper face become those of the lower one, an image further.
void join(ElementMesh& mesh, int axis, const std::string& path, std::vector<int>& lines) {
  const auto [low, high] = extent_of(mesh, axis);
  const double near = kSame * (high - low);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<uint32_t> lower;
  for (uint32_t i = 0; i < mesh.x.size(); ++i)
    if (mesh.x[i][axis] - low < near) lower.push_back(i);
  std::ranges::sort(lower, {}, [&](uint32_t i) { return mesh.x[i][u]; });
  std::map<uint32_t, uint32_t> below;
  for (uint32_t i = 0; i < mesh.x.size(); ++i) {
    if (high - mesh.x[i][axis] >= near) continue;
    const auto first =
        std::ranges::lower_bound(lower, mesh.x[i][u] - near, {}, [&](uint32_t k) { return mesh.x[k][u]; });
    const auto found = std::find_if(first, lower.end(), [&](uint32_t k) {
      return std::abs(mesh.x[k][u] - mesh.x[i][u]) < near && std::abs(mesh.x[k][v] - mesh.x[i][v]) < near;
    });
    if (found == lower.end())
      throw InputError(path, lines[i], 1,
                       fmt::format("vertex {} of the upper face along {} has none across in the lower one",
                                   i + 1, "xyz"[axis]),
                       "make the mesh periodic (Gmsh: Periodic Surface), or leave the axis out of 'repeats'");
    below[i] = *found;
  }
  for (auto& element : mesh.elements)
    for (ElementMesh::Corner& corner : element)
      if (const auto found = below.find(corner.vertex); found != below.end())
        corner.vertex = found->second, ++corner.image[axis];
  std::vector<uint32_t> renumbered(mesh.x.size());
  std::vector<Vec3> kept;
  std::vector<int> kept_lines;
  for (uint32_t i = 0; i < mesh.x.size(); ++i) {
    renumbered[i] = static_cast<uint32_t>(kept.size());
    if (!below.contains(i)) kept.push_back(mesh.x[i]), kept_lines.push_back(lines[i]);
  }
  for (auto& element : mesh.elements)
    for (ElementMesh::Corner& corner : element) corner.vertex = renumbered[corner.vertex];
  mesh.x = std::move(kept);
  lines = std::move(kept_lines);
  mesh.period[axis] = high - low;
}

}  // namespace

ElementMesh read_gmsh(const std::string& path, double unit, const std::array<bool, 3>& repeats) {
  GmshFile file(path, unit);
  ElementMesh mesh = file.read();
  MeshLines lines = file.lines();
  check_mesh(mesh, path, lines);
  for (int axis = 0; axis < 3; ++axis)
    if (repeats[axis]) join(mesh, axis, path, lines.vertices);
  return mesh;
}

}  // namespace cuboct
