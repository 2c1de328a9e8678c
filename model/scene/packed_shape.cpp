// SPDX-License-Identifier: MIT
#include "model/scene/packed_shape.h"

#include <tuple>

#include "model/body/regions.h"
#include "model/scene/scene_parts.h"

namespace cuboct {

std::optional<PackedShape> packed_shape(const Scene& scene) {
  if (!(scene.pitch > 0) || scene.grains > 0) return std::nullopt;
  const ConfigTable root = parse_config(scene.text, scene.path);
  const std::optional<PackingChoice> choice = read_packing(root);
  if (!choice) return std::nullopt;
  PackedShape packed;
  packed.fcc = choice->fcc;
  packed.fcc.pitch = scene.pitch;  // of "relaxed", too
  packed.along = choice->along;
  std::array<bool, 3> periodic{};
  // The scene has been read: its box repeats as it must.
  const SitePeriods sites{
      [&](size_t a, const ConfigValue&) { return choice->along[a]->norm() * packed.fcc.cell(); },
      [](size_t, double) { return true; }};
  std::tie(packed.box, periodic) = read_box(root, &sites);
  const Regions regions(root);
  if (const auto geometry = root.find("geometry")) packed.shape = read_shape(*geometry, regions);
  const std::array<bool, 3> live = live_axes(scene);
  // A single layer stays one: the packing is placed for it.
  Vec3 low = scene.packing().x.front(), high = low;
  for (const Vec3& x : scene.packing().x) low = low.cwiseMin(x), high = high.cwiseMax(x);
  const Vec3 size = high - low;
  for (size_t a = 0; a < 3; ++a)
    packed.free[a] = live[a] && !periodic[a] && size[static_cast<Eigen::Index>(a)] > scene.pitch / 4;
  packed.halves = !root.tables("symmetry").empty();
  return packed;
}

}  // namespace cuboct
