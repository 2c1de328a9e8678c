// SPDX-License-Identifier: MIT
#include "hw/setup.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "hw/reach.h"

namespace cuboct {
namespace {

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
  Lattice lattice(reachable_cells(scene, edge, origin, period), period);
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

// Gives the whole pages among a vector's elements [first, last) back to the system; those elements become
// zeros. (A vector cannot shrink at its front.)
template <typename T>
void give_back(std::vector<T>& values, size_t first, size_t last) {
  static const auto page = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = (reinterpret_cast<uintptr_t>(values.data() + first) + page - 1) / page * page;
  const auto end = reinterpret_cast<uintptr_t>(values.data() + last) / page * page;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
}

}  // namespace

Particle InitialParticles::operator()(uint32_t id) {
  constexpr uint32_t kBlock = 1 << 16;
  if (id > 0 && id % kBlock == 0) {
    // A page that reaches into the block before went with neither block: a few remain.
    give_back(body_.x, id - kBlock, id);
    give_back(body_.v, id - kBlock, id);
    give_back(body_.type, id - kBlock, id);
    if (!body_.u.empty()) give_back(body_.u, id - kBlock, id);
  }
  return fixed_particle(body_, id, plan_.rule, plan_.lattice, plan_.origin);
}

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
