// SPDX-License-Identifier: MIT
#include "model/analysis/scene_cell.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/base/spelling.h"
#include "model/body/packing.h"
#include "model/contract/material_name.h"

namespace cuboct {
namespace {

// The first type of a material: constraints leave no mark here.
uint8_t type_of(const Scene& scene, const std::string& material) {
  std::vector<std::string> names;
  for (size_t k = 0; k < scene.rule.types.size(); ++k) {
    names.push_back(material_of(scene.rule.types[k].name));
    if (material.empty() ? scene.rule.types[k].material == 0 : names.back() == material)
      return static_cast<uint8_t>(k);
  }
  throw InputError(fmt::format("no particle is of the material '{}'", material),
                   did_you_mean(material, names));
}

// The shortest translation of the lattice along an axis of the scene, m; 0 where none is below 24 half cells.
double period(const Fcc& fcc, int axis) {
  constexpr int kMost = 24;
  const Vec3 along = fcc.orientation.row(axis);
  double shortest = 0;
  for (int h = -kMost; h <= kMost; ++h)
    for (int k = -kMost; k <= kMost; ++k)
      for (int l = -kMost; l <= kMost; ++l) {
        const Vec3 at(h, k, l);
        if ((h + k + l) % 2 != 0 || along.dot(at) <= 0 || along.cross(at).norm() > 1e-9 * at.norm()) continue;
        const double length = fcc.cell() / 2 * at.norm();
        if (shortest == 0 || length < shortest) shortest = length;
      }
  return shortest;
}

}  // namespace

SceneCell cell_of(const Scene& scene, const std::string& material) {
  SceneCell out;
  if (scene.periodic.extent.minCoeff() > 0) {
    if (!material.empty())
      throw InputError("--material is for scenes whose box does not repeat along all axes",
                       "the cell is the box, with all its materials");
    out.cell.vectors = diagonal(scene.periodic.extent);
    out.cell.x = scene.body.x;
    out.cell.type = scene.body.type;
    out.of = "the scene's box";
    return out;
  }
  if (scene.pitch == 0)
    scene.places.fail({"particle", "particles.file", "crystal"}, "the scene has no cell that repeats",
                      "give it a [box] with periodic = \"xyz\", or a [packing]");
  const uint8_t type = type_of(scene, material);
  Mat3 primitive;
  primitive << 0, 1, 1, 1, 0, 1, 1, 1, 0;
  out.cell.vectors = scene.pitch / std::numbers::sqrt2 * scene.orientation * primitive;
  out.cell.x = {Vec3::Zero()};
  out.cell.type = {type};
  out.of = fmt::format("{}, of {}", scene.grains > 0 ? "one grain's that is not turned" : "the packing's",
                       material_of(scene.rule.types[type].name));
  return out;
}

CrystalCell slab_of(const Scene& scene, const std::string& material, int layers) {
  if (scene.pitch == 0) throw InputError("a slab is cut from a packing, and the scene has none");
  const Fcc fcc{scene.pitch, scene.orientation, Vec3::Zero()};
  Periodic box;
  for (int axis = 0; axis < 3; ++axis) {
    box.extent[axis] = period(fcc, axis);
    if (box.extent[axis] == 0)
      throw InputError(
          fmt::format("the packing has no short period along {}, which a slab needs", "xyz"[axis]));
  }
  // A little below the sites, so that rounding drops none.
  box.origin = Vec3::Constant(-0.01 * scene.pitch);
  std::vector<Vec3> sites = pack(fcc, nullptr, box);
  std::ranges::sort(sites, {}, [](const Vec3& x) { return x.z(); });
  std::vector<size_t> begin;
  for (size_t i = 0; i < sites.size(); ++i)
    if (i == 0 || sites[i].z() - sites[i - 1].z() > 1e-6 * scene.pitch) begin.push_back(i);
  const size_t each = sites.size() / begin.size();
  CrystalCell slab;
  for (size_t layer = 0; layer < static_cast<size_t>(layers); ++layer) {
    const size_t repeat = layer / begin.size();
    const Vec3 up(0, 0, box.extent.z() * static_cast<double>(repeat));
    for (size_t k = 0; k < each; ++k) slab.x.push_back(sites[begin[layer % begin.size()] + k] + up);
  }
  slab.type.assign(slab.x.size(), type_of(scene, material));
  slab.repeats = {true, true, false};
  box.extent.z() *= layers / static_cast<double>(begin.size());
  slab.vectors = diagonal(box.extent);
  return slab;
}

double density_of(const Rule& rule, const CrystalCell& cell) {
  double mass = 0;
  for (const uint8_t type : cell.type) mass += rule.mass_of(type);
  return mass / cell.volume();
}

}  // namespace cuboct
