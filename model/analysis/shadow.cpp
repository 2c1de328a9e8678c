// SPDX-License-Identifier: MIT
#include "model/analysis/shadow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace cuboct {
namespace {

constexpr double kMostPlaces = 2e6;  // less than a second

using Column = std::array<int64_t, 2>;

}  // namespace

std::optional<Gap> gap_to(const std::vector<Vec3>& x, const std::vector<uint32_t>& ids,
                          const std::vector<uint32_t>& wall, int axis, int side, Vec3 drift, double spacing) {
  const int p = (axis + 1) % 3, q = (axis + 2) % 3;
  const double sign = side == 0 ? -1 : 1;
  drift[axis] = 0;
  const auto column = [&](const Vec3& at) {
    return Column{static_cast<int64_t>(std::floor(at[p] / spacing)),
                  static_cast<int64_t>(std::floor(at[q] / spacing))};
  };
  std::map<Column, std::vector<uint32_t>> walls;
  for (const uint32_t i : wall) walls[column(x[i])].push_back(i);
  std::map<Column, uint32_t> front;  // of each column the particle that is farthest ahead
  for (const uint32_t i : ids) {
    const auto [found, made] = front.try_emplace(column(x[i]), i);
    if (!made && sign * x[i][axis] > sign * x[found->second][axis]) found->second = i;
  }
  const double shifts = std::ceil(drift.norm() / spacing);
  if (!(shifts * static_cast<double>(front.size()) < kMostPlaces)) return std::nullopt;
  Gap gap{std::numeric_limits<double>::infinity(), 0};
  for (const auto& [home, i] : front)
    for (double k = 0; k <= shifts; ++k) {
      const Vec3 at = x[i] + drift * (shifts > 0 ? k / shifts : 0);
      const Column middle = column(at);
      double nearest = std::numeric_limits<double>::infinity();
      for (int64_t u = -1; u <= 1; ++u)
        for (int64_t v = -1; v <= 1; ++v) {
          const auto found = walls.find({middle[0] + u, middle[1] + v});
          if (found == walls.end()) continue;
          for (const uint32_t j : found->second) {
            const double ahead = sign * (x[j][axis] - at[axis]);
            if (ahead > 0 && std::hypot(x[j][p] - at[p], x[j][q] - at[q]) <= spacing)
              nearest = std::min(nearest, ahead);
          }
        }
      if (std::isinf(nearest)) return std::nullopt;
      gap.least = std::min(gap.least, nearest), gap.most = std::max(gap.most, nearest);
    }
  return gap;
}

}  // namespace cuboct
