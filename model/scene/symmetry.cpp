// SPDX-License-Identifier: MIT
#include "model/scene/symmetry.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace cuboct {
namespace {

constexpr size_t kMostPlanes = 6;  // two faces of each axis

// The packing must be its own image: the mirrors of the plane x_a = c of three bonds that make the lattice.
bool mirrors(const Fcc& fcc, int axis) {
  for (const Vec3& hkl : {Vec3(1, 1, 0), Vec3(1, 0, 1), Vec3(0, 1, 1)}) {
    Vec3 bond = fcc.orientation * (fcc.cell() / 2 * hkl);
    bond[axis] = -bond[axis];
    if (!is_period(fcc, bond)) return false;
  }
  return true;
}

template <typename T>
void grow(std::vector<std::vector<T>>& table, const std::vector<size_t>& origin) {
  if (table.empty()) return;
  std::vector<std::vector<T>> grown(origin.size(), std::vector<T>(origin.size()));
  for (size_t i = 0; i < origin.size(); ++i)
    for (size_t j = 0; j < origin.size(); ++j) grown[i][j] = table[origin[i]][origin[j]];
  table = std::move(grown);
}

std::string axes_of(const std::vector<SymmetryPlane>& planes, unsigned in) {
  std::string axes;
  for (size_t p = 0; p < planes.size(); ++p)
    if ((in >> p & 1) != 0) axes += "xyz"[planes[p].axis];
  return axes;
}

// By particle.
std::vector<uint8_t> planes_of(const std::vector<SymmetryPlane>& planes, const std::vector<Vec3>& x,
                               double tolerance, double cutoff) {
  std::vector<uint8_t> in(x.size(), 0);
  for (size_t p = 0; p < planes.size(); ++p) {
    const SymmetryPlane& plane = planes[p];
    size_t inside = 0, below = 0, above = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < x.size(); ++i) {
      const double off = x[i][plane.axis] - plane.place;
      if (std::abs(off) <= tolerance) {
        in[i] = static_cast<uint8_t>(in[i] | 1u << p);
        ++inside;
        continue;
      }
      ++(off < 0 ? below : above);
      nearest = std::min(nearest, std::abs(off));
    }
    if (inside == 0)
      plane.key.fail("no particle stands in this plane",
                     fmt::format("the nearest stand {:.6g} m off it", nearest));
    if (below > 0 && above > 0)
      plane.key.fail(
          fmt::format("particles stand on both sides of this plane: {} below it, {} above", below, above),
          "the geometry is the half that is computed");
    if (2 * nearest < cutoff * (1 - 1e-9))
      plane.key.fail(
          fmt::format("particles stand {:.6g} m off this plane, and would feel their images: the cutoff "
                      "is {:.6g} m",
                      nearest, cutoff),
          "a law of a shorter cutoff, or a cubic axis of the packing along the normal");
  }
  return in;
}

}  // namespace

double part_beside(unsigned planes) { return std::ldexp(1.0, -std::popcount(planes)); }

std::vector<SymmetryPlane> read_symmetry(const ConfigTable& root, const PackingChoice* packing,
                                         const Scene& scene) {
  std::vector<SymmetryPlane> planes;
  for (const ConfigTable& table : root.tables("symmetry")) {
    if (planes.size() == kMostPlanes) table.fail(fmt::format("more than {} planes of symmetry", kMostPlanes));
    const ConfigValue normal = table.at("normal");
    const Vec3 n = normal.direction().cwiseAbs();
    SymmetryPlane plane{0, 0, table};
    n.maxCoeff(&plane.axis);
    if (n[plane.axis] < n.norm())
      normal.fail("'normal' must be an axis of the scene", "\"x\", \"y\" or \"z\"");
    plane.place = table.vector_or("point", quantity::length, Vec3::Zero())[plane.axis];
    table.done();
    const char name = "xyz"[plane.axis];
    if (scene.periodic.extent[plane.axis] > 0)
      normal.fail(fmt::format("the box repeats along {}: it has no plane of symmetry there", name));
    if (packing != nullptr && packing->grains && packing->grains->grains.column_axis != plane.axis)
      normal.fail(fmt::format("grains are not their own mirror image along {}", name),
                  fmt::format("grains that are columns along it: texture = \"{}\"", name));
    if (packing != nullptr && !mirrors(packing->fcc, plane.axis))
      normal.fail(fmt::format("the packing is not its own mirror image along {}", name),
                  "'axes' of [packing] with a cubic axis along the normal");
    for (const SymmetryPlane& other : planes)
      if (other.axis == plane.axis && other.place == plane.place) table.fail("this plane is there twice");
    planes.push_back(std::move(plane));
  }
  return planes;
}

Divided divide(const std::vector<SymmetryPlane>& planes, const std::vector<Vec3>& x, double tolerance,
               std::vector<int>& material, std::vector<std::string>& names, Rule& rule) {
  const std::vector<uint8_t> in = planes_of(planes, x, tolerance, rule.cutoff());
  const size_t before = names.size();
  Divided out;
  out.planes.assign(before, 0);
  std::vector<size_t> origin(before);
  std::iota(origin.begin(), origin.end(), size_t{0});
  std::map<std::pair<int, uint8_t>, int> found;
  for (size_t i = 0; i < x.size(); ++i) {
    if (in[i] == 0) continue;
    const auto [at, fresh] = found.try_emplace({material[i], in[i]}, static_cast<int>(origin.size()));
    if (fresh) {
      const auto m = static_cast<size_t>(material[i]);
      origin.push_back(m);
      out.planes.push_back(in[i]);
      names.push_back(fmt::format("{}:{}", names[m], axes_of(planes, in[i])));
    }
    material[i] = at->second;
  }
  grow(rule.strength, origin);
  grow(rule.law_index, origin);
  grow(rule.contact, origin);
  if (rule.masses.empty()) rule.masses.assign(before, rule.mass);
  for (size_t m = before; m < origin.size(); ++m) rule.masses.push_back(rule.masses[origin[m]]);
  out.whole = rule;
  for (size_t i = 0; i < origin.size(); ++i) {
    rule.masses[i] *= part_beside(out.planes[i]);
    for (size_t j = 0; j < origin.size(); ++j)
      rule.strength[i][j] *= part_beside(out.planes[i] & out.planes[j]);
  }
  rule.mass = *std::ranges::min_element(rule.masses);
  return out;
}

void check_gravity(const std::vector<SymmetryPlane>& planes, const Vec3& gravity) {
  for (const SymmetryPlane& plane : planes)
    if (gravity[plane.axis] != 0)
      plane.key.fail(
          fmt::format("gravity along {} is not its own mirror image at this plane", "xyz"[plane.axis]),
          "only planes along which it acts can be planes of symmetry");
}

void keep_in_planes(const std::vector<SymmetryPlane>& planes, uint8_t in, ParticleType& type) {
  for (size_t p = 0; p < planes.size(); ++p) {
    if ((in >> p & 1) == 0) continue;
    const int axis = planes[p].axis;
    if (type.pd)
      planes[p].key.fail(fmt::format("'{}' holds particles of this plane by force", type.name),
                         "leave the plane out of its region, or take 'held' or 'moved'");
    if (type.imposed[static_cast<size_t>(axis)] && type.velocity[axis] != 0)
      planes[p].key.fail(fmt::format("'{}' moves particles out of this plane", type.name));
    if (type.pull[axis] != 0)
      planes[p].key.fail(fmt::format("'{}' pulls particles out of this plane", type.name),
                         "leave the plane out of its region");
    type.imposed[static_cast<size_t>(axis)] = true;
    type.velocity[axis] = 0;
  }
}

}  // namespace cuboct
