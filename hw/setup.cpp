// SPDX-License-Identifier: MIT
#include "hw/setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cuboct {
namespace {

constexpr double kMostCells = 3e7;  // about 3 GB of lattice

// A periodic axis must be a ring of whole cells, all of one edge: the shortest edge, not below `least`, that
// divides every periodic extent. Without periodic axes it is `least`.
double periodic_edge(const Vec3& extent, double least) {
  const double longest = extent.maxCoeff();
  if (longest <= 0) return least;
  for (int n = static_cast<int>(std::floor(longest / least * (1 + 1e-12))); n >= 3; --n) {
    const double edge = longest / n;
    bool fits = true;
    for (int a = 0; a < 3; ++a) {
      const double cells = extent[a] / edge;
      if (extent[a] > 0 && (std::abs(cells - std::round(cells)) > 1e-9 * cells || std::round(cells) < 3))
        fits = false;
    }
    if (fits) return edge;
  }
  throw InputError(
      fmt::format(
          "no cell edge of at least {:.6g} m divides the periodic box {:.6g} x {:.6g} x {:.6g} m into 3 "
          "or more cells per axis",
          least, extent[0], extent[1], extent[2]),
      "use a larger box, or one whose sides have a common part");
}

// Every cell that a box touches.
void add_box(std::vector<Cell>& cells, const Vec3& low, const Vec3& high, const Vec3& origin, double edge,
             const Cell& period) {
  std::array<int32_t, 3> first, last;
  double count = 1;
  for (int a = 0; a < 3; ++a) count *= (high[a] - low[a]) / edge + 1;
  if (!(count < kMostCells) || !((high - origin).cwiseAbs().maxCoeff() < 1e9 * edge) ||
      !((low - origin).cwiseAbs().maxCoeff() < 1e9 * edge))
    throw InputError(fmt::format("the reach spans {:.3g} cells of {:.4g} m: at most {:.3g} can be built",
                                 count, edge, kMostCells),
                     "a smaller reach.margin or reach box");
  for (int a = 0; a < 3; ++a) {
    first[a] = static_cast<int32_t>(std::floor((low[a] - origin[a]) / edge));
    last[a] = static_cast<int32_t>(std::floor((high[a] - origin[a]) / edge));
    if (period[a] > 0) last[a] = std::min(last[a], first[a] + period[a] - 1);
  }
  for (int32_t z = first[2]; z <= last[2]; ++z)
    for (int32_t y = first[1]; y <= last[1]; ++y)
      for (int32_t x = first[0]; x <= last[0]; ++x) cells.push_back({x, y, z});
}

// The cells that the body, its margin, its driven types on their way and the extra box touch.
std::vector<Cell> reachable(const Scene& scene, double edge, const Vec3& origin, const Cell& period) {
  const Vec3 margin = scene.reach_margin.minCoeff() < 0 ? Vec3(Vec3::Constant(edge)) : scene.reach_margin;
  const double duration = static_cast<double>(scene.steps) * scene.rule.dt;
  std::vector<Cell> cells;
  size_t kept = size_t{1} << 22;
  for (size_t id = 0; id < scene.body.size(); ++id) {
    const ParticleType& type = scene.rule.types[scene.body.type[id]];
    const Vec3 way = type.velocity * duration;
    const int stops = 1 + static_cast<int>(std::ceil(way.norm() / (0.5 * edge)));
    for (int k = 0; k <= (way.norm() > 0 ? stops : 0); ++k) {
      const Vec3 at = scene.body.x[id] + way * k / stops;
      add_box(cells, at - margin, at + margin, origin, edge, period);
    }
    if (cells.size() > kept) {  // neighbours list the same cells: keep the list short
      std::sort(cells.begin(), cells.end());
      cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
      if (static_cast<double>(cells.size()) > kMostCells)
        throw InputError(fmt::format("the body can reach {} cells of {:.4g} m: at most {:.3g} can be built",
                                     cells.size(), edge, kMostCells));
      kept = std::max(kept, 2 * cells.size());
    }
  }
  if (scene.reach[0] != scene.reach[1]) add_box(cells, scene.reach[0], scene.reach[1], origin, edge, period);
  return cells;
}

// `see` is given each particle of the initial state once, in the order of ids.
template <typename See>
Plan plan_with(const Scene& scene, const Arch& arch, See see) {
  const double cutoff = scene.rule.law->cutoff();
  if (arch.cell_edge > 0 && arch.cell_edge < cutoff)
    throw InputError(fmt::format("cell_edge = {:.6g} m is shorter than the pair law's cutoff, {:.6g} m",
                                 arch.cell_edge, cutoff));
  const double edge = periodic_edge(scene.periodic.extent, std::max(cutoff, arch.cell_edge));

  // Cells start a quarter of an edge below the body, so that the planes of an aligned crystal do not lie on
  // faces.
  Vec3 origin = Vec3::Constant(INFINITY);
  for (const Vec3& x : scene.body.x) origin = origin.cwiseMin(x);
  origin.array() -= 0.25 * edge;
  Cell period{};
  for (int a = 0; a < 3; ++a)
    if (scene.periodic.extent[a] > 0) {
      period[a] = static_cast<int32_t>(std::lround(scene.periodic.extent[a] / edge));
      origin[a] = scene.periodic.origin[a];
    }

  FixedRule rule = quantise(scene.rule, edge, arch.widths, arch.table);
  Lattice lattice(reachable(scene, edge, origin, period), period);
  std::vector<uint32_t> count(lattice.size(), 0);
  uint32_t fullest = 0;
  for (uint32_t id = 0; id < scene.body.size(); ++id) {
    const Particle particle = fixed_particle(scene.body, id, rule, lattice, origin);
    fullest = std::max(fullest, ++count[particle.node]);
    see(particle);
  }
  if (static_cast<int64_t>(fullest) > arch.capacity)
    throw InputError(
        fmt::format("a node would hold {} particles: its capacity is {}", fullest, arch.capacity),
        fmt::format("set node.capacity to at least {} in the arch file", fullest));
  return make_plan(std::move(rule), arch, std::move(lattice), origin,
                   static_cast<uint32_t>(scene.body.size()));
}

}  // namespace

Plan plan_of(const Scene& scene, const Arch& arch) {
  return plan_with(scene, arch, [](const Particle&) {});
}

Setup make_setup(const Scene& scene, const Arch& arch) {
  State initial;
  initial.particles.reserve(scene.body.size());
  Plan plan =
      plan_with(scene, arch, [&](const Particle& particle) { initial.particles.push_back(particle); });
  return {std::move(plan), std::move(initial)};
}

}  // namespace cuboct
