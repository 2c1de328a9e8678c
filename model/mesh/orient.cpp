// SPDX-License-Identifier: MIT
#include <limits>
#include <utility>

#include "model/mesh/surface.h"

namespace cuboct {
namespace {

// Sets that are joined two at a time (R. Tarjan, 1975), and whether a member is turned against its set's
// first.
class Joined {
 public:
  struct Link {
    uint32_t to;
    bool turned;
  };
  explicit Joined(size_t count) {
    for (uint32_t k = 0; k < count; ++k) links_.push_back({k, false});
  }
  Link first(uint32_t member) {
    Link way{member, false};
    while (links_[way.to].to != way.to) way = {links_[way.to].to, way.turned != links_[way.to].turned};
    for (Link at{member, way.turned}; at.to != way.to;) {
      const Link next = std::exchange(links_[at.to], {way.to, at.turned});
      at = {next.to, at.turned != next.turned};
    }
    return way;
  }
  void join(uint32_t a, uint32_t b, bool turned) {
    const Link of_a = first(a), of_b = first(b);
    if (of_a.to != of_b.to) links_[of_a.to] = {of_b.to, (of_a.turned != of_b.turned) != turned};
  }

 private:
  std::vector<Link> links_;
};

}  // namespace

size_t orient(Surface& surface) {
  const size_t count = surface.triangles.size();
  Joined joined(count);
  size_t turned = 0;
  const std::vector<Edge> edges = edges_of(surface);
  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].joins(edges[begin])) ++end;
    if (end - begin != 2) continue;
    const Edge &a = edges[begin], &b = edges[begin + 1];
    turned += a.along == b.along ? 1 : 0;
    joined.join(a.triangle, b.triangle, a.along == b.along);
  }
  std::vector<double> majority(count);  // m^2, of those turned as the set's first less the others'
  for (uint32_t t = 0; t < count; ++t) {
    const auto [set, other] = joined.first(t);
    majority[set] += (other ? -1 : 1) * area_vector(surface, t).norm();
  }
  constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> shell_of(count, kNone);
  uint32_t shells = 0;
  surface.shells.resize(count);
  for (uint32_t t = 0; t < count; ++t) {
    const auto [set, other] = joined.first(t);
    if (shell_of[set] == kNone) shell_of[set] = shells++;
    surface.shells[t] = shell_of[set];
    if (other != (majority[set] < 0)) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
  }
  return turned;
}

}  // namespace cuboct
