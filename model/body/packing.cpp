// SPDX-License-Identifier: MIT
#include "model/body/packing.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include "model/base/error.h"
#include "model/base/parallel.h"
#include "model/body/packing_parts.h"

namespace cuboct {

std::pair<double, double> inside_bounds(const Vec3& start, const Vec3& step, const Bounds& bounds,
                                        double slack) {
  std::pair<double, double> in{-1e9, 1e9};
  for (int a = 0; a < 3; ++a) {
    const double low = bounds.low[a] - slack - start[a], high = bounds.high[a] + slack - start[a];
    if (std::abs(step[a]) < 1e-9 * slack) {
      if (low > 0 || high < 0) return {1, 0};
      continue;
    }
    in.first = std::max(in.first, std::min(low / step[a], high / step[a]));
    in.second = std::min(in.second, std::max(low / step[a], high / step[a]));
  }
  return in;
}

double Fcc::cell() const { return std::numbers::sqrt2 * pitch; }

double particle_mass(double density, double pitch) {
  return density * pitch * pitch * pitch / std::numbers::sqrt2;
}

Bounds packing_bounds(const Shape* shape, const Periodic& box) {
  Bounds bounds = shape != nullptr ? shape->bounds() : Bounds{};
  for (int a = 0; a < 3; ++a) {
    if (box.extent[a] == 0) continue;
    bounds.low[a] = std::max(bounds.low[a], box.origin[a]);
    bounds.high[a] = std::min(bounds.high[a], box.origin[a] + box.extent[a]);
  }
  if (!bounds.low.allFinite() || !bounds.high.allFinite()) throw InputError("the geometry has no end");
  return bounds;
}

Bounds indices_in(const Fcc& fcc, const Bounds& bounds) {
  Bounds range{Vec3::Constant(std::numeric_limits<double>::infinity()),
               Vec3::Constant(-std::numeric_limits<double>::infinity())};
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = (corner >> a & 1) != 0 ? bounds.high[a] : bounds.low[a];
    const Vec3 c = fcc.orientation.transpose() * (x - fcc.offset) / (fcc.cell() / 2);
    range.low = range.low.cwiseMin(c);
    range.high = range.high.cwiseMax(c);
  }
  return range;
}

SiteIndices site_indices(const Fcc& fcc, const Bounds& bounds) {
  const Bounds range = indices_in(fcc, bounds);
  SiteIndices indices;
  for (int a = 0; a < 3; ++a) {
    indices.first[a] = std::llround(std::floor(range.low[a])) - 1;
    indices.last[a] = std::llround(std::ceil(range.high[a])) + 1;
  }
  return indices;
}

PackingSize packing_size(const Fcc& fcc, const Shape* shape, const Periodic& box) {
  const Bounds bounds = packing_bounds(shape, box);
  const Bounds range = indices_in(fcc, bounds);
  PackingSize size;
  size.farthest = std::max(range.low.cwiseAbs().maxCoeff(), range.high.cwiseAbs().maxCoeff());
  Vec3 along_axes;
  for (int a = 0; a < 3; ++a) along_axes[a] = std::ceil(range.high[a]) - std::floor(range.low[a]) + 3;
  const double all = along_axes.prod() / 2;           // every other (h, k, l) is a site
  const double rows = along_axes[1] * along_axes[2];  // a look at least at each
  // A site stands for pitch^3/sqrt(2). Along an axis both faces may hold a plane of sites.
  const Vec3 extent = bounds.high - bounds.low;
  size.sites = std::numbers::sqrt2 / std::pow(fcc.pitch, 3);
  for (int a = 0; a < 3; ++a) size.sites *= extent[a] + (box.extent[a] == 0 ? fcc.pitch / 2 : 0);
  size.sites = std::min(size.sites, all);
  size.tested = rows;
  if (shape == nullptr) return size;
  constexpr double kSamples = 32768, kMostWork = 3e7;
  const int along =
      static_cast<int>(std::cbrt(std::clamp(kMostWork / static_cast<double>(shape->parts()), 8.0, kSamples)));
  int inside = 0;
  // Of a row's sites pack() passes over those that are nearer to one than its surface is.
  double looked = 0;
  for (int l = 0; l < along; ++l)
    for (int k = 0; k < along; ++k)
      for (int h = 0; h < along; ++h) {
        const Vec3 x = bounds.low + (Vec3(h, k, l) + Vec3::Constant(0.5)).cwiseProduct(extent) / along;
        const double distance = shape->distance(x);
        inside += distance <= kSiteTolerance * fcc.pitch ? 1 : 0;
        looked += std::min(1.0, fcc.cell() / std::abs(distance));
      }
  size.tested += size.sites * looked / std::pow(along, 3);
  size.sites *= inside / std::pow(along, 3);
  return size;
}

std::vector<Vec3> pack(const Fcc& fcc, const Shape* shape, const Periodic& box) {
  const Bounds bounds = packing_bounds(shape, box);
  const double tolerance = kSiteTolerance * fcc.pitch;
  const double half = fcc.cell() / 2;
  const SiteIndices indices = site_indices(fcc, bounds);
  const std::array<int64_t, 3>&first = indices.first, &last = indices.last;

  const auto plane = [&](int64_t l) {
    std::vector<Vec3> sites;
    for (int64_t k = first[1]; k <= last[1]; ++k) {
      const Vec3 start =
          fcc.offset + half * fcc.orientation * Vec3(0, static_cast<double>(k), static_cast<double>(l));
      const auto [from, to] = inside_bounds(start, half * fcc.orientation.col(0), bounds, half);
      const int64_t begin = from > static_cast<double>(first[0]) ? std::llround(std::ceil(from)) : first[0];
      const int64_t end = to < static_cast<double>(last[0]) ? std::llround(std::floor(to)) : last[0];
      // No part of the surface is nearer than the last site's distance to it: sites of the row within that
      // are as that one was.
      bool held = shape == nullptr;
      double clear = shape == nullptr ? std::numeric_limits<double>::infinity() : 0, passed = 0;
      // The first h of the row at which h + k + l is even.
      for (int64_t h = begin + ((begin + k + l) & 1); h <= end; h += 2) {
        if (!held && passed < clear) {
          const double over = std::ceil((clear - passed) / (2 * half));
          if (over > static_cast<double>(end - h) / 2) break;
          h += 2 * static_cast<int64_t>(over);
          passed += 2 * half * over;
        }
        const Vec3 hkl(static_cast<double>(h), static_cast<double>(k), static_cast<double>(l));
        Vec3 x = fcc.offset + fcc.orientation * (half * hkl);
        if (passed >= clear) {
          const double distance = shape->distance(x);
          held = distance <= tolerance;
          clear = std::abs(distance) - 2 * tolerance, passed = 0;
        }
        passed += 2 * half;
        bool inside = held;
        for (int a = 0; a < 3 && inside; ++a) {
          if (box.extent[a] == 0) continue;
          const double in = x[a] - box.origin[a];
          inside = in >= -tolerance && in < box.extent[a] - tolerance;
          if (in < 0) x[a] = box.origin[a];
        }
        if (inside) sites.push_back(x);
      }
    }
    return sites;
  };
  std::vector<std::vector<Vec3>> planes(static_cast<size_t>(last[2] - first[2] + 1));
  for_each_range(planes.size(), 4, [&](size_t begin, size_t end) {
    for (size_t l = begin; l < end; ++l) planes[l] = plane(first[2] + static_cast<int64_t>(l));
  });
  std::vector<Vec3> sites;
  for (std::vector<Vec3>& of : planes) {
    sites.insert(sites.end(), of.begin(), of.end());
    of = {};
  }
  return sites;
}

bool is_period(const Fcc& fcc, const Vec3& shift) {
  const Vec3 hkl = fcc.orientation.transpose() * shift / (fcc.cell() / 2);
  int64_t sum = 0;
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(hkl[a] - std::round(hkl[a])) < kSiteTolerance)) return false;
    sum += std::llround(hkl[a]);
  }
  return (sum & 1) == 0;
}

namespace {

// Normal deviates in a fixed order.
class Deviates {
 public:
  explicit Deviates(uint64_t seed) : generator_(seed) {}

  Vec3 next() {
    Vec3 d;
    for (int a = 0; a < 3; ++a) {
      if (have_spare_) {
        d[a] = spare_;
      } else {
        const double radius = std::sqrt(-2 * std::log(uniform(generator_)));
        const double angle = 2 * std::numbers::pi * uniform(generator_);
        d[a] = radius * std::cos(angle);
        spare_ = radius * std::sin(angle);
      }
      have_spare_ = !have_spare_;
    }
    return d;
  }

 private:
  std::mt19937_64 generator_;
  double spare_ = 0;
  bool have_spare_ = false;
};

}  // namespace

void add_thermal(std::vector<Vec3>& v, const std::vector<uint32_t>& ids, double speed, uint64_t seed,
                 const std::function<ThermalShare(uint32_t id)>& share) {
  if (ids.empty()) return;
  // Drawn twice, once for the mean: kept, the draws would take half as much memory as the body.
  Vec3 mean = Vec3::Zero();
  double mass = 0;
  Deviates first(seed), again(seed);
  for (const uint32_t id : ids) {
    const ThermalShare of = share(id);
    mean += of.mass * of.speed * first.next();
    mass += of.mass;
  }
  mean /= mass;
  for (const uint32_t id : ids) v[id] += speed * (share(id).speed * again.next() - mean);
}

}  // namespace cuboct
