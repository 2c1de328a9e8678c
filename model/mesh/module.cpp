// SPDX-License-Identifier: MIT
// The module that makes a solid of the triangles that cuboct-read-mesh left.
#include <cmath>
#include <filesystem>
#include <fstream>

#include "model/mesh/solid.h"
#include "model/mesh/triangle_file.h"

namespace cuboct {
namespace {

// What left the file may have been led astray by what it read: nothing of it is believed.
bool read(const std::string& path, TriangleFileHead& head, Surface& surface) {
  std::ifstream in(path, std::ios::binary);
  const auto get = [&](void* to, size_t bytes) {
    return static_cast<bool>(in.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes)));
  };
  if (!get(&head, sizeof head)) return false;
  const uint64_t bytes = std::filesystem::file_size(path) - sizeof head;
  if (head.points > bytes || head.triangles > bytes ||
      head.points * sizeof(Vec3) + head.triangles * 3 * sizeof(uint32_t) != bytes)
    return false;
  surface.points.resize(head.points);
  surface.triangles.resize(head.triangles);
  if (!get(surface.points.data(), head.points * sizeof(Vec3)) ||
      !get(surface.triangles.data(), head.triangles * 3 * sizeof(uint32_t)))
    return false;
  for (const auto& triangle : surface.triangles)
    for (const uint32_t point : triangle)
      if (point >= head.points) return false;
  return std::isfinite(head.unit) && head.unit >= 0 && std::isfinite(head.rounding);
}

double size_of(const Surface& surface) {
  if (surface.points.empty()) return 0;
  Vec3 low = surface.points[0], high = low;
  for (const Vec3& x : surface.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  return (high - low).maxCoeff();
}

}  // namespace

extern "C" void cuboct_read_mesh(const std::string& triangles, std::optional<double> unit, Mesh& mesh,
                                 std::string& error) {
  TriangleFileHead head;
  Surface surface;
  if (!read(triangles, head, surface)) {
    error = "it holds triangles of points that are not there";
    return;
  }
  MeshFacts& facts = mesh.facts;
  facts.stated_unit = head.unit, facts.up = static_cast<char>(head.up);
  facts.unit = unit.value_or(head.unit);
  if (facts.unit == 0) return;  // the caller says what is missing
  for (Vec3& x : surface.points) x *= facts.unit;
  facts.rounding = head.rounding * facts.unit;
  facts.size = size_of(surface);
  if (facts.too_coarse()) return;
  facts.flat = join_points(surface);
  if (surface.triangles.empty()) {
    error = "no triangle with an area";
    return;
  }
  facts.turned = orient(surface);
  look_at(surface, facts);
  mesh.shape = solid_within(std::move(surface), facts);
}

}  // namespace cuboct
