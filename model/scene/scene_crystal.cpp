// SPDX-License-Identifier: MIT
// [crystal] of a scene: atoms on the sites of graphene or diamond, in [box] and [geometry].
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "model/base/resources.h"
#include "model/scene/scene_parts.h"

namespace cuboct {
namespace {

constexpr double kBondTolerance = 1e-6;  // of the bond, as of a packing's pitch

Vec3 edges_of(const CrystalChoice& crystal) { return {crystal.edge(0), crystal.edge(1), crystal.edge(2)}; }

// Sites of the cell at the origin.
std::vector<Vec3> basis_of(const CrystalChoice& crystal) {
  std::vector<Vec3> sites = right_cell(crystal.lattice, crystal.bond).x;
  if (crystal.turned)
    for (Vec3& x : sites) std::swap(x[0], x[1]);
  return sites;
}

SitePeriods periods_of(const CrystalChoice& crystal) {
  return {[&crystal](size_t a, const ConfigValue&) { return crystal.edge(a); },
          [&crystal](size_t a, double extent) {
            const double cells = extent / crystal.edge(a);
            return crystal.repeats(a) &&
                   std::abs(cells - std::round(cells)) * crystal.edge(a) < kBondTolerance * crystal.bond;
          }};
}

// Cells of the crystal that may have a site within the bounds.
struct CellRange {
  std::array<int64_t, 3> first{}, last{};
  double count = 1;
};

CellRange cells_in(const CrystalChoice& crystal, const Bounds& bounds) {
  CellRange range;
  for (size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    if (!crystal.repeats(a)) continue;
    const double low = (bounds.low[axis] - crystal.offset[axis]) / crystal.edge(a) - 1;
    const double high = (bounds.high[axis] - crystal.offset[axis]) / crystal.edge(a) + 1;
    range.count *= high - low;
    if (!(range.count < 1e12)) return range;
    range.first[a] = std::llround(std::floor(low)), range.last[a] = std::llround(std::ceil(high));
  }
  return range;
}

void check_count(const ConfigValue& at, double sites) {
  constexpr double kBytes = 64, kMost = 4e9;  // of an atom while it is read; ids have 32 bits
  const double free = static_cast<double>(free_memory()), most = std::min(kMost, free / kBytes);
  if (sites <= most) return;
  at.fail(fmt::format("about {:.3g} atoms: {:.3g} fit into the memory that is free", sites, most),
          "a smaller box or geometry");
}

// Where the box holds the site, its position there: a site on the upper face is that on the lower one.
std::optional<Vec3> in_box(Vec3 x, const Periodic& box, double tolerance) {
  for (int a = 0; a < 3; ++a) {
    if (box.extent[a] == 0) continue;
    const double in = x[a] - box.origin[a];
    if (in < -tolerance || in >= box.extent[a] - tolerance) return std::nullopt;
    if (in < 0) x[a] = box.origin[a];
  }
  return x;
}

}  // namespace

double CrystalChoice::edge(size_t axis) const {
  if (lattice == AtomLattice::diamond) return bond * 4 / std::numbers::sqrt3;
  if (axis == 2) return bond;
  return (axis == 0) != turned ? bond * std::numbers::sqrt3 : 3 * bond;
}

std::optional<CrystalChoice> read_crystal(const ConfigTable& root) {
  const auto table = root.table_at("crystal");
  if (!table) return std::nullopt;
  root.not_both("packing", "crystal");
  CrystalChoice crystal{.table = *table};
  crystal.lattice = static_cast<AtomLattice>(table->at("lattice").choice("lattice", {"graphene", "diamond"}));
  const bool sheet = crystal.lattice == AtomLattice::graphene;
  table->not_both("bond", "edge");
  if (const auto edge = table->find("edge")) {
    if (sheet) edge->fail("'edge' is of the cube of lattice = \"diamond\"", "give 'bond'");
    crystal.bond = edge->number(quantity::length, Range::positive()) * std::numbers::sqrt3 / 4;
  } else if (const auto bond = table->find("bond"); bond && bond->string() != "relaxed") {
    crystal.bond = bond->number(quantity::length, Range::positive());
  }
  crystal.offset = table->vector_or("offset", quantity::length, Vec3::Zero());
  if (const auto zigzag = table->find("zigzag")) {
    if (!sheet) zigzag->fail("'zigzag' is of lattice = \"graphene\"");
    crystal.turned = zigzag->choice("axis", {"x", "y"}) == 1;
  }
  table->done();
  return crystal;
}

void place_crystal(const ConfigTable& root, const Regions& regions, const CrystalChoice& crystal,
                   Scene& scene) {
  const SitePeriods sites = periods_of(crystal);
  const auto [box, periodic] = read_box(root, &sites);
  for (size_t a = 0; a < 3; ++a) {
    if (periodic[a] && !crystal.repeats(a))
      root.at("box").table().at("periodic").fail(fmt::format("graphene does not repeat along {}", "xyz"[a]));
    if (periodic[a]) scene.periodic.extent[static_cast<int>(a)] = box.extent[static_cast<int>(a)];
  }
  scene.periodic.origin = box.origin;
  const auto geometry = root.find("geometry");
  if (!geometry && box.extent.isZero(0))
    crystal.table.fail("nothing says where the crystal ends", "add [geometry], or [box] with 'cells'");
  ShapePtr shape;
  Bounds bounds;
  if (geometry) shape = read_shape(*geometry, regions), bounds = shape->bounds();
  for (int a = 0; a < 3; ++a) {
    if (box.extent[a] > 0) {
      bounds.low[a] = std::max(bounds.low[a], box.origin[a]);
      bounds.high[a] = std::min(bounds.high[a], box.origin[a] + box.extent[a]);
    }
    if (crystal.repeats(static_cast<size_t>(a)) && !std::isfinite(bounds.high[a] - bounds.low[a]))
      geometry->fail(fmt::format("the geometry has no end along {}", "xyz"[a]));
  }
  const std::vector<Vec3> basis = basis_of(crystal);
  const CellRange cells = cells_in(crystal, bounds);
  const ConfigValue place = geometry ? *geometry : root.at("box");
  check_count(place, cells.count * static_cast<double>(basis.size()));
  const Vec3 edges = edges_of(crystal);
  const double tolerance = kBondTolerance * crystal.bond;
  for (int64_t l = cells.first[2]; l <= cells.last[2]; ++l)
    for (int64_t k = cells.first[1]; k <= cells.last[1]; ++k)
      for (int64_t h = cells.first[0]; h <= cells.last[0]; ++h) {
        const Vec3 hkl(static_cast<double>(h), static_cast<double>(k), static_cast<double>(l));
        for (const Vec3& site : basis) {
          const Vec3 at = crystal.offset + hkl.cwiseProduct(edges) + site;
          if (shape != nullptr && shape->distance(at) > tolerance) continue;
          if (const auto x = in_box(at, box, tolerance)) scene.body.x.push_back(*x);
        }
      }
  if (scene.body.x.empty()) place.fail("no atom: no site of the crystal lies inside");
  scene.body.v.assign(scene.body.x.size(), Vec3::Zero());
}

}  // namespace cuboct
