// SPDX-License-Identifier: MIT
#include "model/body/packing_scatter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/body/packing_parts.h"

namespace cuboct {
namespace {

constexpr int kPlaces = 7;             // sections of each axis
constexpr int kShifts = 16;            // of the packing, across the axis
constexpr double kMostSites = 1e7;     // held against a shape of few parts
constexpr double kPartsOfASite = 600;  // that take as long again, where a tree finds the nearest
constexpr double kLeastChange = 0.01;  // of a section that is told

// m, after how much the crystal repeats along a direction of least integers.
double period(const Fcc& fcc, const Vec3& direction) {
  const bool even = std::llround(direction.sum()) % 2 == 0;
  return fcc.cell() * direction.norm() / (even ? 2 : 1);
}

// The k-th point of R2 (M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018), k >= 1.
std::array<double, 2> quasirandom(int k) {
  constexpr double kRoot = 1.32471795724474602596;  // of x^3 = x + 1
  const auto part = [](double value) { return value - std::floor(value); };
  return {part(0.5 + k / kRoot), part(0.5 + k / (kRoot * kRoot))};
}

// Whole layers of sites across an axis.
struct Slab {
  int axis;
  double low, length;  // m
};

struct Moments {
  double area = 0;             // m^2
  Vec3 second = Vec3::Zero();  // m^4, about the centre, of distances along each axis
};

Moments moments_in(const PackedShape& packed, const Slab& slab, const Vec3& shift) {
  Fcc fcc = packed.fcc;
  fcc.offset += shift;
  Bounds within = packing_bounds(packed.shape.get(), packed.box);
  const Vec3 beyond = Vec3::Constant(fcc.pitch);
  within.low -= beyond, within.high += beyond;
  within.low[slab.axis] = slab.low, within.high[slab.axis] = slab.low + slab.length;
  const ShapePtr layers = box(within.low, within.high);
  const ShapePtr shape = packed.shape ? intersect({packed.shape, layers}) : layers;
  const std::vector<Vec3> sites = pack(fcc, shape.get(), packed.box);
  Moments moments;
  const double share = particle_mass(1, fcc.pitch) / slab.length;
  moments.area = share * static_cast<double>(sites.size());
  if (sites.empty()) return moments;
  Vec3 centre = Vec3::Zero();
  for (const Vec3& x : sites) centre += x;
  centre /= static_cast<double>(sites.size());
  for (const Vec3& x : sites) moments.second += share * (x - centre).cwiseAbs2();
  return moments;
}

// Slabs of whole layers at even distances within the body, that begin between two layers.
std::vector<Slab> slabs_across(const PackedShape& packed, int axis, int places) {
  const Bounds bounds = packing_bounds(packed.shape.get(), packed.box);
  const Vec3& direction = *packed.along[static_cast<size_t>(axis)];
  const double spacing = layer_spacing(packed.fcc, direction), length = bounds.high[axis] - bounds.low[axis];
  const double layers = std::floor(std::min(period(packed.fcc, direction), length / 2) / spacing + 1e-6);
  if (layers < 1) return {};
  std::vector<Slab> slabs;
  for (int k = 1; k <= places; ++k) {
    const double begin =
        bounds.low[axis] + (length - layers * spacing) * k / (places + 1) - packed.fcc.offset[axis];
    slabs.push_back(
        {axis, packed.fcc.offset[axis] + (std::round(begin / spacing) - 0.5) * spacing, layers * spacing});
  }
  return slabs;
}

PackedSection section_in(const PackedShape& packed, const Slab& slab) {
  const int b = (slab.axis + 1) % 3, c = (slab.axis + 2) % 3;
  const auto range = [&](int axis) {
    const auto& along = packed.along[static_cast<size_t>(axis)];
    constexpr double kTurned = 10;  // pitches, where nothing repeats
    if (!packed.free[static_cast<size_t>(axis)]) return 0.0;
    return along ? period(packed.fcc, *along) : kTurned * packed.fcc.pitch;
  };
  const Moments here = moments_in(packed, slab, Vec3::Zero());
  std::vector<Moments> all{here};
  Moments mean;
  for (int k = 1; k <= kShifts; ++k) {
    const auto [u, v] = quasirandom(k);
    const Vec3 shift = u * range(b) * Vec3::Unit(b) + v * range(c) * Vec3::Unit(c);
    all.push_back(moments_in(packed, slab, shift));
    mean.area += all.back().area / kShifts;
    mean.second += all.back().second / kShifts;
  }
  PackedSection section{.axis = slab.axis, .at = slab.low + slab.length / 2, .mean = mean.area};
  const auto share_of = [&](auto value) {
    const double of = value(mean);
    PackedSection::Share share;
    if (!(of > 0)) return share;
    share.packed = value(here) / of;
    const auto [least, most] = std::ranges::minmax(all, {}, value);
    share.least = value(least) / of, share.most = value(most) / of;
    return share;
  };
  section.area = share_of([](const Moments& m) { return m.area; });
  for (const int axis : {b, c}) {
    if (!packed.free[static_cast<size_t>(axis)]) continue;
    const auto bending = share_of([axis](const Moments& m) { return m.second[axis]; });
    if (bending.range() > section.bending.range()) section.bending = bending;
  }
  return section;
}

}  // namespace

double layer_spacing(const Fcc& fcc, const Vec3& direction) {
  const bool odd = std::ranges::all_of(
      direction, [](double h) { return std::round(std::abs(h)) - 2 * std::floor(std::abs(h) / 2) == 1; });
  return fcc.cell() / 2 / direction.norm() * (odd ? 2 : 1);
}

std::optional<PackedSection> packed_section(const PackedShape& packed) {
  const Bounds bounds = packing_bounds(packed.shape.get(), packed.box);
  const Vec3 extent = bounds.high - bounds.low;
  const double sites = extent.prod() / particle_mass(1, packed.fcc.pitch);
  std::optional<PackedSection> found;
  if (packed.halves) return found;
  const double parts = packed.shape ? static_cast<double>(packed.shape->parts()) : 1,
               most = kMostSites / (1 + parts / kPartsOfASite) / 3 / (kShifts + 1);
  for (int axis = 0; axis < 3; ++axis) {
    const size_t a = static_cast<size_t>(axis);
    if (!packed.along[a] || (!packed.free[(a + 1) % 3] && !packed.free[(a + 2) % 3])) continue;
    const double in_slab = sites * std::min(1.0, period(packed.fcc, *packed.along[a]) / extent[axis]);
    const int places = static_cast<int>(std::min(most / in_slab, double{kPlaces}));
    std::optional<PackedSection> thinnest;
    for (const Slab& slab : slabs_across(packed, axis, places)) {
      const PackedSection section = section_in(packed, slab);
      // A section of less than a site or two says nothing.
      if (section.mean < 2 * packed.fcc.pitch * packed.fcc.pitch) continue;
      if (!thinnest || section.mean < thinnest->mean) thinnest = section;
    }
    if (!thinnest || std::max(thinnest->area.range(), thinnest->bending.range()) < kLeastChange) continue;
    if (!found || thinnest->mean < found->mean) found = thinnest;
  }
  return found;
}

}  // namespace cuboct
