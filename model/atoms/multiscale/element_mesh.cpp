// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/element_mesh.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>

#include "model/base/error.h"

namespace cuboct {
namespace {

using Index3 = std::array<int, 3>;

constexpr std::array<Index3, 6> kOrders{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};

// Of an element, relative to the cube of its longest edge: a regular tetrahedron has 0.118, rounding 1e-16.
constexpr double kFlat = 1e-9;

class Box {
 public:
  Box(const Index3& cubes, const Vec3& size, const std::array<bool, 3>& repeats) : cubes_(cubes) {
    for (int a = 0; a < 3; ++a) {
      if (repeats[a]) mesh_.period[a] = size[a];
      vertices_[a] = repeats[a] ? cubes[a] : cubes[a] + 1;
    }
    Index3 at;
    for (at[2] = 0; at[2] < vertices_[2]; ++at[2])
      for (at[1] = 0; at[1] < vertices_[1]; ++at[1])
        for (at[0] = 0; at[0] < vertices_[0]; ++at[0])
          mesh_.x.push_back(
              Vec3(at[0] * size[0] / cubes[0], at[1] * size[1] / cubes[1], at[2] * size[2] / cubes[2]));
  }

  void add_cube(const Index3& cube, uint32_t first_grain, bool each) {
    for (size_t k = 0; k < kOrders.size(); ++k) {
      std::array<ElementMesh::Corner, 4> element;
      Index3 local{};
      element[0] = corner(cube, local);
      for (int step = 0; step < 3; ++step) {
        local[kOrders[k][step]] = 1;
        element[step + 1] = corner(cube, local);
      }
      // Odd orders of axes and mirrors both turn the tetrahedron over.
      if ((k >= 3) != ((cube[0] + cube[1] + cube[2]) % 2 == 1)) std::swap(element[2], element[3]);
      mesh_.elements.push_back(element);
      mesh_.grain.push_back(each ? static_cast<uint32_t>(mesh_.grain.size()) : first_grain);
    }
  }

  ElementMesh take() { return std::move(mesh_); }

 private:
  ElementMesh::Corner corner(const Index3& cube, const Index3& local) const {
    ElementMesh::Corner out;
    Index3 at;
    for (int a = 0; a < 3; ++a) {
      at[a] = cube[a] + (cube[a] % 2 == 0 ? local[a] : 1 - local[a]);
      if (at[a] == vertices_[a]) at[a] = 0, out.image[a] = 1;
    }
    out.vertex = static_cast<uint32_t>((at[2] * vertices_[1] + at[1]) * vertices_[0] + at[0]);
    return out;
  }

  Index3 cubes_, vertices_{};
  ElementMesh mesh_;
};

}  // namespace

uint32_t ElementMesh::grains() const { return grain.empty() ? 0 : *std::ranges::max_element(grain) + 1; }

Vec3 corner_place(const ElementMesh::Corner& corner, const std::vector<Vec3>& x, const Vec3& period) {
  return x[corner.vertex] + period.cwiseProduct(Vec3(corner.image[0], corner.image[1], corner.image[2]));
}

double signed_volume(const Vec3& a, const Vec3& b, const Vec3& c) { return a.cross(b).dot(c) / 6; }

double element_volume(const ElementMesh& mesh, size_t element) {
  std::array<Vec3, 4> p;
  for (int k = 0; k < 4; ++k) p[k] = corner_place(mesh.elements[element][k], mesh.x, mesh.period);
  return signed_volume(p[1] - p[0], p[2] - p[0], p[3] - p[0]);
}

void check_mesh(const ElementMesh& mesh, const std::string& name, const MeshLines& lines) {
  const auto fail = [&](const std::vector<int>& line, size_t k, const std::string& message,
                        const std::string& hint = {}) {
    if (k < line.size()) throw InputError(name, line[k], 1, message, hint);
    throw InputError(fmt::format("{}: {}", name, message), hint);
  };
  std::vector<bool> used(mesh.x.size(), false);
  for (size_t e = 0; e < mesh.elements.size(); ++e) {
    double longest = 0;
    for (const ElementMesh::Corner& corner : mesh.elements[e]) {
      if (corner.vertex >= mesh.x.size())
        fail(lines.elements, e,
             fmt::format("element {} has vertex {} of {}", e + 1, corner.vertex + 1, mesh.x.size()));
      used[corner.vertex] = true;
      longest = std::max(longest, (corner_place(corner, mesh.x, mesh.period) -
                                   corner_place(mesh.elements[e][0], mesh.x, mesh.period))
                                      .norm());
    }
    const double volume = element_volume(mesh, e);
    if (!(volume > kFlat * longest * longest * longest))
      fail(lines.elements, e,
           fmt::format("element {} is {}: its volume is {:.3g} m^3", e + 1, volume < 0 ? "inverted" : "flat",
                       volume),
           volume < 0 ? "exchange two of its vertices" : "");
  }
  if (const auto orphan = std::ranges::find(used, false); orphan != used.end()) {
    const auto k = static_cast<size_t>(orphan - used.begin());
    fail(lines.vertices, k, fmt::format("vertex {} belongs to no element", k + 1),
         "a vertex without an element has no mass and no force");
  }
}

ElementMesh box_mesh(const Index3& cubes, const Vec3& size, const std::array<bool, 3>& repeats,
                     int grain_cubes) {
  Box box(cubes, size, repeats);
  const int block = std::max(grain_cubes, 1);
  const Index3 blocks{(cubes[0] + block - 1) / block, (cubes[1] + block - 1) / block, 0};
  Index3 cube;
  for (cube[2] = 0; cube[2] < cubes[2]; ++cube[2])
    for (cube[1] = 0; cube[1] < cubes[1]; ++cube[1])
      for (cube[0] = 0; cube[0] < cubes[0]; ++cube[0])
        box.add_cube(cube,
                     static_cast<uint32_t>(((cube[2] / block) * blocks[1] + cube[1] / block) * blocks[0] +
                                           cube[0] / block),
                     grain_cubes == 0);
  return box.take();
}

}  // namespace cuboct
