// SPDX-License-Identifier: MIT
#include "model/analysis/motion_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "model/analysis/motion.h"

namespace cuboct {
namespace {

bool led(const ParticleType& type) { return type.pd || type.imposed != std::array<bool, 3>{}; }

// m/s, of all that moves freely at the start; none where nothing does.
std::optional<Vec3> carried(const Scene& scene) {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (size_t i = 0; i < scene.body.size(); ++i)
    if (!led(scene.rule.types[scene.body.type[i]])) sum += scene.body.v[i], ++count;
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace

std::vector<std::string> motion_warnings(const Scene& scene) {
  std::vector<std::string> warnings;
  if (scene.loading) return warnings;  // each load step is at rest
  const auto moves = [](const ParticleType& type) { return led(type) && !type.velocity.isZero(0); };
  if (std::ranges::none_of(scene.rule.types, moves)) return warnings;
  const double c = motion_of(scene).sound_speed;
  const std::optional<Vec3> free = carried(scene);
  for (const ParticleType& type : scene.rule.types) {
    const double speed = free && moves(type) ? (type.velocity - *free).norm() : 0;
    if (c > 0 && speed > c)
      warnings.push_back(fmt::format(
          "'{}' is moved at {:.4g} m/s, {:.2g} times as fast as waves travel, {:.4g} m/s: it tears off, or "
          "through, as nothing can follow",
          type.name, speed, speed / c, c));
  }
  return warnings;
}

}  // namespace cuboct
