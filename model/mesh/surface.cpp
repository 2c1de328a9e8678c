// SPDX-License-Identifier: MIT
#include "model/mesh/surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>

namespace cuboct {
Vec3 area_vector(const Surface& surface, size_t triangle) {
  const Vec3 a = surface.corner(triangle, 0);
  return 0.5 * (surface.corner(triangle, 1) - a).cross(surface.corner(triangle, 2) - a);
}

std::vector<Edge> edges_of(const Surface& surface) {
  std::vector<Edge> edges;
  edges.reserve(3 * surface.triangles.size());
  for (uint32_t t = 0; t < surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const uint32_t from = surface.triangles[t][k], to = surface.triangles[t][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  std::ranges::sort(edges, {}, [](const Edge& e) { return std::tuple(e.low, e.high, e.triangle); });
  return edges;
}

size_t join_points(Surface& surface) {
  const std::vector<Vec3>& points = surface.points;
  std::vector<uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](uint32_t i) { return std::tuple(points[i][0], points[i][1], points[i][2]); };
  std::ranges::sort(order, {}, key);
  std::vector<uint32_t> now(points.size());
  std::vector<Vec3> joined;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || key(order[i]) != key(order[i - 1])) joined.push_back(points[order[i]]);
    now[order[i]] = static_cast<uint32_t>(joined.size() - 1);
  }
  for (auto& triangle : surface.triangles)
    for (uint32_t& point : triangle) point = now[point];
  surface.points = std::move(joined);
  std::vector<std::array<uint32_t, 3>> whole;
  for (size_t t = 0; t < surface.triangles.size(); ++t)
    if (area_vector(surface, t).squaredNorm() > 0) whole.push_back(surface.triangles[t]);
  const size_t flat = surface.triangles.size() - whole.size();
  surface.triangles = std::move(whole);
  return flat;
}

void look_at(const Surface& surface, MeshFacts& facts) {
  facts.triangles = surface.triangles.size();
  for (size_t t = 0; t < surface.triangles.size(); ++t) facts.area += area_vector(surface, t).norm();
  const std::vector<Edge> edges = edges_of(surface);
  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    size_t along = 0;
    for (; end < edges.size() && edges[end].joins(edges[begin]); ++end) along += edges[end].along ? 1 : 0;
    const size_t count = end - begin;
    if (2 * along == count) continue;  // the triangles of one side go along it, those of the other back
    ++(count == 1 ? facts.open : count == 2 ? facts.one_sided : facts.crowded);
  }
}

std::vector<double> volumes_of(const Surface& surface) {
  std::vector<double> volumes(*std::ranges::max_element(surface.shells) + 1);
  const Vec3 origin = surface.points[surface.triangles[0][0]];  // near the body: less to cancel
  for (size_t t = 0; t < surface.triangles.size(); ++t)
    volumes[surface.shells[t]] += area_vector(surface, t).dot(surface.corner(t, 0) - origin) / 3;
  return volumes;
}

Vec3 nearest_point(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax), d3 = ab.dot(bx), d4 = ac.dot(bx), d5 = ab.dot(cx),
               d6 = ac.dot(cx);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

}  // namespace cuboct
