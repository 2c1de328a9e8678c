// SPDX-License-Identifier: MIT
#include "model/analysis/common_neighbours.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "model/analysis/near_within.h"

namespace cuboct {
namespace {

constexpr size_t kClose = 12, kBcc = 14;  // neighbours
constexpr double kBetween =
    (1 + std::numbers::sqrt2) / 2;  // of the first shell: half-way to the second of a close packing

struct Signature {
  int common, bonds, least, most;
  bool operator==(const Signature&) const = default;
};

// bonded[j]: a bit for each neighbour that has a bond with neighbour j.
Signature signature(const std::array<uint32_t, kBcc>& bonded, size_t j) {
  const uint32_t common = bonded[j];
  Signature of{std::popcount(common), 0, static_cast<int>(kBcc), 0};
  for (uint32_t left = common; left != 0; left &= left - 1) {
    const int bonds = std::popcount(bonded[static_cast<size_t>(std::countr_zero(left))] & common);
    of.bonds += bonds;
    of.least = std::min(of.least, bonds), of.most = std::max(of.most, bonds);
  }
  of.bonds /= 2;
  return of;
}

// Of the first `count` neighbours, 12 or 14, m from the particle.
Structure structure_of(const Vec3* d, size_t count, double cutoff) {
  std::array<uint32_t, kBcc> bonded{};
  for (size_t j = 0; j < count; ++j)
    for (size_t k = j + 1; k < count; ++k)
      if ((d[j] - d[k]).squaredNorm() < cutoff * cutoff) bonded[j] |= 1U << k, bonded[k] |= 1U << j;
  size_t fcc = 0, hcp = 0, icosahedral = 0, bcc4 = 0, bcc6 = 0;
  for (size_t j = 0; j < count; ++j) {
    const Signature of = signature(bonded, j);
    fcc += of == Signature{4, 2, 1, 1};
    hcp += of == Signature{4, 2, 0, 2};
    icosahedral += of == Signature{5, 5, 2, 2};
    bcc4 += of == Signature{4, 4, 2, 2};
    bcc6 += of == Signature{6, 6, 2, 2};
  }
  if (count == kBcc) return bcc4 == 6 && bcc6 == 8 ? Structure::bcc : Structure::other;
  if (fcc == 12) return Structure::fcc;
  if (fcc == 6 && hcp == 6) return Structure::hcp;
  return icosahedral == 12 ? Structure::icosahedral : Structure::other;
}

// The nearest neighbours first; of equals the one of less id.
struct Nearest {
  std::vector<std::pair<double, uint32_t>> by_distance;  // m^2
  std::array<Vec3, kBcc> d;
  std::array<double, kBcc> r;

  size_t find(const std::vector<Vec3>& x, const Periodic& periodic, uint32_t i,
              std::span<const uint32_t> near) {
    by_distance.clear();
    for (const uint32_t j : near)
      by_distance.emplace_back(nearest_image(x[j] - x[i], periodic).squaredNorm(), j);
    const size_t count = std::min(kBcc, by_distance.size());
    std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<ptrdiff_t>(count),
                      by_distance.end());
    for (size_t k = 0; k < count; ++k) {
      d[k] = nearest_image(x[by_distance[k].second] - x[i], periodic);
      r[k] = std::sqrt(by_distance[k].first);
    }
    return count;
  }
};

Structure adaptive(const Nearest& nearest, size_t count) {
  if (count < kClose) return Structure::other;
  double sum = 0;
  for (size_t k = 0; k < kClose; ++k) sum += nearest.r[k];
  const Structure close = structure_of(nearest.d.data(), kClose, kBetween * sum / kClose);
  if (close != Structure::other || count < kBcc) return close;
  sum = 0;
  for (size_t k = 0; k < kBcc; ++k) sum += k < 8 ? 2 / std::numbers::sqrt3 * nearest.r[k] : nearest.r[k];
  return structure_of(nearest.d.data(), kBcc, kBetween * sum / kBcc);
}

}  // namespace

const char* to_string(Structure structure) {
  static constexpr const char* kNames[kStructures] = {"other", "fcc", "hcp", "bcc", "icosahedral"};
  return kNames[static_cast<size_t>(structure)];
}

std::vector<Structure> structures_within(const std::vector<Vec3>& x, const Periodic& periodic, double cutoff,
                                         int threads) {
  check_range(cutoff, periodic, "cutoff");
  std::vector<Structure> found(x.size(), Structure::other);
  for_each_near(x, periodic, cutoff, threads, [&](size_t, uint32_t i, std::span<const uint32_t> near) {
    if (near.size() != kClose && near.size() != kBcc) return;
    std::array<Vec3, kBcc> d;
    for (size_t k = 0; k < near.size(); ++k) d[k] = nearest_image(x[near[k]] - x[i], periodic);
    found[i] = structure_of(d.data(), near.size(), cutoff);
  });
  return found;
}

std::vector<Structure> structures_adaptive(const std::vector<Vec3>& x, const Periodic& periodic, double reach,
                                           int threads) {
  check_range(reach, periodic, "reach");
  std::vector<Structure> found(x.size(), Structure::other);
  std::vector<Nearest> nearest(static_cast<size_t>(threads > 0 ? threads : usable_cores()));
  for_each_near(x, periodic, reach, threads, [&](size_t member, uint32_t i, std::span<const uint32_t> near) {
    Nearest& of = nearest[member];
    found[i] = adaptive(of, of.find(x, periodic, i, near));
  });
  return found;
}

}  // namespace cuboct
