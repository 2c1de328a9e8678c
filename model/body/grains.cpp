// SPDX-License-Identifier: MIT
#include "model/body/grains.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "model/base/parallel.h"
#include "model/body/packing_parts.h"
#include "model/body/random_turn.h"
#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

// A grid of blocks over the domain, their edges half a size or longer. It has one block along the axis of
// columns.
class Blocks {
 public:
  Blocks(const Grains& grains, const GrainDomain& domain) : domain_(domain), flat_(grains.column_axis) {
    for (int a = 0; a < 3; ++a) {
      count_[a] = a == flat_ ? 1 : std::max(1, static_cast<int>(domain.extent[a] / (grains.size / 2)));
      edge_[a] = domain.extent[a] / count_[a];
    }
  }

  size_t size() const { return static_cast<size_t>(count_[0]) * count_[1] * count_[2]; }
  std::array<int, 3> at(const Vec3& x) const {
    std::array<int, 3> block;
    for (int a = 0; a < 3; ++a)
      block[a] =
          std::clamp(static_cast<int>(std::floor((x[a] - domain_.low[a]) / edge_[a])), 0, count_[a] - 1);
    return block;
  }
  size_t index(const std::array<int, 3>& block) const {
    return (static_cast<size_t>(block[2]) * count_[1] + block[1]) * count_[0] + block[0];
  }
  Bounds bounds(size_t index) const {
    const auto i = static_cast<int>(index % count_[0]), j = static_cast<int>(index / count_[0] % count_[1]),
               k = static_cast<int>(index / count_[0] / count_[1]);
    const Vec3 low = domain_.low + edge_.cwiseProduct(Vec3(i, j, k));
    return {low, low + edge_};
  }
  // Calls on(block, shift) for each block that has a point within `reach` of block `home`'s middle; `shift`
  // counts the periods from the block to that image.
  template <typename On>
  void for_each_within(size_t home, double reach, const On& on) const {
    const std::array<int, 3> at = this->at((bounds(home).low + bounds(home).high) / 2);
    std::array<int, 3> low, high;
    for (int a = 0; a < 3; ++a) {
      const int most = a == flat_ ? 0 : static_cast<int>(std::ceil(reach / edge_[a]));
      low[a] = at[a] - most, high[a] = at[a] + most;
      if (!domain_.repeats[a] || a == flat_)
        low[a] = std::max(low[a], 0), high[a] = std::min(high[a], count_[a] - 1);
    }
    for (int k = low[2]; k <= high[2]; ++k)
      for (int j = low[1]; j <= high[1]; ++j)
        for (int i = low[0]; i <= high[0]; ++i) {
          const std::array<int, 3> image{i, j, k};
          std::array<int, 3> block, shift;
          for (int a = 0; a < 3; ++a) {
            shift[a] = static_cast<int>(std::floor(static_cast<double>(image[a]) / count_[a]));
            block[a] = image[a] - shift[a] * count_[a];
          }
          on(index(block), shift);
        }
  }

 private:
  GrainDomain domain_;
  int flat_;
  std::array<int, 3> count_{};
  Vec3 edge_ = Vec3::Zero();  // m
};

// About one axis. What lies along it keeps its coordinate to the last bit: a flat sheet stays flat.
Mat3 turn_about(int axis, std::mt19937_64& generator) {
  double x, y, square;
  do {
    x = 2 * uniform(generator) - 1, y = 2 * uniform(generator) - 1, square = x * x + y * y;
  } while (!(square < 1 && square > 0));
  const double c = x / std::sqrt(square), s = y / std::sqrt(square);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  Mat3 turn = Mat3::Zero();
  turn(axis, axis) = 1;
  turn(u, u) = turn(v, v) = c;
  turn(v, u) = s, turn(u, v) = -s;
  return turn;
}

struct Image {
  uint32_t grain = 0;
  std::array<int, 3> shift{};  // periods
  auto operator<=>(const Image&) const = default;
};

// Which grain's image holds a point.
class Voronoi {
 public:
  Voronoi(const Grains& grains, const GrainDomain& domain, const std::vector<Grain>& all)
      : domain_(domain),
        flat_(grains.column_axis),
        grains_(all),
        blocks_(grains, domain),
        near_(blocks_.size()) {
    std::vector<std::vector<uint32_t>> inside(blocks_.size());
    for (uint32_t g = 0; g < all.size(); ++g) inside[blocks_.index(blocks_.at(all[g].centre))].push_back(g);
    for_each_range(blocks_.size(), 64, [&](size_t begin, size_t end) {
      for (size_t b = begin; b < end; ++b) near_[b] = nearest(b, grains.size, inside);
    });
  }

  Vec3 centre(const Image& image) const {
    Vec3 at = grains_[image.grain].centre;
    for (int a = 0; a < 3; ++a) at[a] += image.shift[a] * domain_.extent[a];
    return at;
  }
  // Images that hold some point of the domain, ascending, each with bounds of what it holds.
  std::vector<std::pair<Image, Bounds>> images() const {
    std::vector<std::pair<Image, Bounds>> all;
    for (size_t b = 0; b < near_.size(); ++b)
      for (const Image& image : near_[b]) all.emplace_back(image, blocks_.bounds(b));
    std::ranges::stable_sort(all, {}, &std::pair<Image, Bounds>::first);
    std::vector<std::pair<Image, Bounds>> merged;
    for (const auto& [image, bounds] : all) {
      if (merged.empty() || merged.back().first != image) {
        merged.emplace_back(image, bounds);
        continue;
      }
      Bounds& last = merged.back().second;
      last.low = last.low.cwiseMin(bounds.low), last.high = last.high.cwiseMax(bounds.high);
    }
    return merged;
  }
  // Of images that are equally near the first.
  Image owner(const Vec3& x) const {
    const std::vector<Image>& near = near_[blocks_.index(blocks_.at(x))];
    Image best;
    double least = std::numeric_limits<double>::infinity();
    for (const Image& image : near)
      if (const double square = across(x, centre(image)); square < least) least = square, best = image;
    return best;
  }

 private:
  // m^2, without the way along columns.
  double across(const Vec3& a, const Vec3& b) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (axis != flat_) sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
    return sum;
  }
  // All images that may hold a point of the block. A point is no further than h from the block's middle, h
  // half its diagonal: what is nearest to the point is no further from the middle than 2h beyond what is
  // nearest to the middle.
  std::vector<Image> nearest(size_t block, double size,
                             const std::vector<std::vector<uint32_t>>& inside) const {
    const Bounds bounds = blocks_.bounds(block);
    const Vec3 middle = (bounds.low + bounds.high) / 2;
    const double diagonal = std::sqrt(across(bounds.low, bounds.high));
    for (double reach = size + diagonal;;) {
      std::vector<std::pair<double, Image>> found;
      blocks_.for_each_within(block, reach, [&](size_t other, const std::array<int, 3>& shift) {
        for (const uint32_t g : inside[other]) {
          const Image image{g, shift};
          found.emplace_back(std::sqrt(across(middle, centre(image))), image);
        }
      });
      double least = std::numeric_limits<double>::infinity();
      for (const auto& [distance, image] : found) least = std::min(least, distance);
      const double enough = (least + diagonal) * (1 + 1e-9);
      if (!(enough <= reach)) {
        reach = std::isinf(enough) ? 2 * reach : enough;
        continue;
      }
      std::vector<Image> near;
      for (const auto& [distance, image] : found)
        if (distance <= enough) near.push_back(image);
      std::ranges::sort(near);
      return near;
    }
  }

  GrainDomain domain_;
  int flat_;
  const std::vector<Grain>& grains_;
  Blocks blocks_;
  std::vector<std::vector<Image>> near_;  // [block], ascending
};

// Whether a site is in the box, with pack()'s tolerance: those a little below its lower faces are put there.
bool take_into(const Periodic& box, double tolerance, Vec3& x) {
  for (int a = 0; a < 3; ++a) {
    if (box.extent[a] == 0) continue;
    const double in = x[a] - box.origin[a];
    if (!(in >= -tolerance && in < box.extent[a] - tolerance)) return false;
    if (in < 0) x[a] = box.origin[a];
  }
  return true;
}

// No part of the surface is nearer to the middle than its distance; sites are met a half cell beyond.
bool is_clear_of(const Shape& shape, const Bounds& bounds, double slack) {
  const double half = (bounds.high - bounds.low).norm() / 2;
  return shape.distance((bounds.low + bounds.high) / 2) > half + slack;
}

// Calls on(x) for the sites of the crystal within the bounds and a half cell around them, ascending in (l, k,
// h).
template <typename On>
void for_each_site(const Fcc& fcc, const Bounds& bounds, const On& on) {
  const double half = fcc.cell() / 2;
  const SiteIndices indices = site_indices(fcc, bounds);
  const std::array<int64_t, 3>&first = indices.first, &last = indices.last;
  for (int64_t l = first[2]; l <= last[2]; ++l)
    for (int64_t k = first[1]; k <= last[1]; ++k) {
      const Vec3 start =
          fcc.offset + half * fcc.orientation * Vec3(0, static_cast<double>(k), static_cast<double>(l));
      const auto [from, to] = inside_bounds(start, half * fcc.orientation.col(0), bounds, half);
      const int64_t begin = from > static_cast<double>(first[0]) ? std::llround(std::ceil(from)) : first[0];
      const int64_t end = to < static_cast<double>(last[0]) ? std::llround(std::floor(to)) : last[0];
      for (int64_t h = begin + ((begin + k + l) & 1); h <= end; h += 2)
        on(Vec3(fcc.offset + fcc.orientation * (half * Vec3(static_cast<double>(h), static_cast<double>(k),
                                                            static_cast<double>(l)))));
    }
}

void leave_out_close(std::vector<Vec3>& sites, double closest, const GrainDomain& domain) {
  Periodic repeats{.origin = domain.low};
  for (int a = 0; a < 3; ++a)
    if (domain.repeats[a]) repeats.extent[a] = domain.extent[a];
  CellList cells(closest, repeats);
  cells.build(sites);
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  cells.for_each_pair(sites, [&](uint32_t i, uint32_t j, const Vec3&, double) {
    pairs.emplace_back(i, j);
    pairs.emplace_back(j, i);
  });
  std::ranges::sort(pairs);
  std::vector<uint32_t> begin(sites.size() + 1, 0);
  for (const auto& [i, j] : pairs) ++begin[i + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < sites.size(); ++i)
    if (begin[i + 1] > begin[i]) order.push_back(i);
  std::ranges::stable_sort(order, {}, [&](uint32_t i) { return begin[i + 1] - begin[i]; });
  std::vector<char> out(sites.size(), 0);
  for (const uint32_t i : order) {
    if (out[i]) continue;
    for (uint32_t at = begin[i]; at < begin[i + 1]; ++at) out[pairs[at].second] = 1;
  }
  size_t kept = 0;
  for (size_t i = 0; i < sites.size(); ++i)
    if (!out[i]) sites[kept++] = sites[i];
  sites.resize(kept);
}

}  // namespace

Vec3 GrainDomain::between(const Vec3& a, const Vec3& b) const {
  Vec3 d = b - a;
  for (int axis = 0; axis < 3; ++axis)
    if (repeats[axis]) d[axis] -= extent[axis] * std::round(d[axis] / extent[axis]);
  return d;
}

GrainDomain grain_domain(const Shape* shape, const Periodic& box, const std::array<bool, 3>& repeats) {
  const Bounds bounds = packing_bounds(shape, box);
  GrainDomain domain{bounds.low, bounds.high - bounds.low, repeats};
  for (int a = 0; a < 3; ++a)
    if (repeats[a]) domain.low[a] = box.origin[a], domain.extent[a] = box.extent[a];
  return domain;
}

double grain_count(const Grains& grains, const GrainDomain& domain) {
  double count = 1;
  for (int a = 0; a < 3; ++a)
    if (a != grains.column_axis) count *= std::max(1.0, domain.extent[a] / grains.size);
  return std::round(count);
}

std::vector<Grain> draw_grains(const Grains& grains, const GrainDomain& domain) {
  const auto count = static_cast<size_t>(grain_count(grains, domain));
  const Blocks blocks(grains, domain);
  std::vector<std::vector<uint32_t>> inside(blocks.size());
  std::mt19937_64 generator(grains.seed);
  std::vector<Grain> all;
  // Half a size apart, centres fill the space to less than a third of where no further one would find room.
  while (all.size() < count) {
    Grain grain;
    for (int a = 0; a < 3; ++a)
      if (a != grains.column_axis) grain.centre[a] = domain.low[a] + uniform(generator) * domain.extent[a];
    const size_t home = blocks.index(blocks.at(grain.centre));
    bool room = true;
    // Around the block's middle: a centre may stand in its corner.
    blocks.for_each_within(home, grains.size, [&](size_t block, const std::array<int, 3>&) {
      for (const uint32_t other : inside[block])
        room = room && domain.between(grain.centre, all[other].centre).norm() >= grains.size / 2;
    });
    if (!room) continue;
    grain.turn = grains.column_axis < 0 ? random_turn(generator) : turn_about(grains.column_axis, generator);
    inside[home].push_back(static_cast<uint32_t>(all.size()));
    all.push_back(grain);
  }
  return all;
}

std::vector<Vec3> pack_grains(const Fcc& fcc, const Grains& grains, const Shape* shape, const Periodic& box,
                              const std::array<bool, 3>& repeats) {
  const GrainDomain domain = grain_domain(shape, box, repeats);
  const std::vector<Grain> all = draw_grains(grains, domain);
  const Voronoi voronoi(grains, domain, all);
  const double tolerance = kSiteTolerance * fcc.pitch;
  const std::vector<std::pair<Image, Bounds>> images = voronoi.images();
  std::vector<std::vector<Vec3>> parts(images.size());
  for_each_range(images.size(), 2, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const Image& image = images[k].first;
      const Bounds& bounds = images[k].second;
      if (shape != nullptr && is_clear_of(*shape, bounds, fcc.cell())) continue;
      const Fcc crystal{fcc.pitch, all[image.grain].turn * fcc.orientation,
                        voronoi.centre(image) + fcc.offset};
      for_each_site(crystal, bounds, [&](Vec3 x) {
        if (!take_into(box, tolerance, x) || voronoi.owner(x) != image) return;
        if (shape == nullptr || shape->distance(x) <= tolerance) parts[k].push_back(x);
      });
    }
  });
  std::vector<Vec3> sites;
  for (std::vector<Vec3>& part : parts) {
    sites.insert(sites.end(), part.begin(), part.end());
    part = {};
  }
  leave_out_close(sites, grains.closest * fcc.pitch, domain);
  return sites;
}

}  // namespace cuboct
