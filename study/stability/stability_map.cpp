// SPDX-License-Identifier: MIT
#include "study/stability/stability_map.h"

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/parallel.h"
#include "study/sweep/measure_run.h"

namespace cuboct::study {
namespace {

constexpr size_t kMostParticles = 5000;
constexpr double kResolution = 0.01;  // of a cell's verdict: a fifth of a cell's height

// What stands in one column.
struct Column {
  Scene scene;
  Arch arch;
  double strain = 0;
};

std::vector<double> even(double from, double to, int count) {
  std::vector<double> out;
  for (int k = 0; k < count; ++k) out.push_back(from + (to - from) * k / (count - 1));
  return out;
}

struct Frame {
  std::string name, title, x_label;
  std::vector<double> x;
  Arithmetic arithmetic;
};

template <typename ColumnAt>
StabilityMap map_of(const Frame& frame, int axis, int fineness, double unit, const ColumnAt& column_at,
                    const std::function<void(const std::string&, double)>& progress) {
  const std::vector<double> y = even(0.65 / fineness, 1.3 - 0.65 / fineness, fineness);
  StabilityMap map{frame.name, frame.title, frame.x_label, frame.x, y, {}, {}};
  const size_t nx = map.x.size();
  map.cells.assign(nx * map.y.size(), StabilityMap::Cell::body_unstable);
  map.theory.assign(nx, std::numeric_limits<double>::quiet_NaN());
  std::atomic<size_t> done = 0, next = 0;
  std::mutex telling;
  std::string failure;
  // Columns take unlike times: each thread takes the next one that nobody has.
  for_each_range(nx, 1, [&](size_t, size_t) {
    for (size_t i = next++; i < nx; i = next++) {
      try {
        const Column column = column_at(map.x[i]);
        const Subject subject = subject_of(column.scene, axis, column.strain);
        if (std::isfinite(subject.limit.dt)) map.theory[i] = subject.limit.dt / unit;
        const uint64_t steps = steps_to_tell(subject.limit, kResolution);
        for (size_t k = 0; k < map.y.size() && subject.measurable; ++k) {
          const TrialVerdict verdict =
              try_step(subject, column.arch, {frame.arithmetic}, map.y[k] * unit, kResolution, steps).verdict;
          map.cells[k * nx + i] = static_cast<StabilityMap::Cell>(verdict);
        }
      } catch (const Interrupted&) {
        return;
      } catch (const std::exception& error) {
        const std::lock_guard lock(telling);
        failure = error.what();
        return;
      }
      const std::lock_guard lock(telling);
      progress(frame.name, static_cast<double>(++done) / static_cast<double>(nx));
    }
  });
  if (interrupted()) throw Interrupted();
  if (!failure.empty()) throw std::runtime_error(fmt::format("map '{}': {}", frame.name, failure));
  return map;
}

// The scene's PD-held particles, else the lowest layer, held by force without a kd.
Scene held_by_force(Scene scene, int axis, double kp) {
  bool any = false;
  for (ParticleType& type : scene.rule.types)
    if (type.pd) any = true, type.kp = kp, type.kd = 0;
  if (!any) {
    double low = INFINITY;
    for (const Vec3& x : scene.body.x) low = std::min(low, x[axis]);
    const double layer = 0.25 * length_unit(scene);
    // One more type for each that stands there.
    const std::vector<ParticleType> before = scene.rule.types;
    std::vector<int> held(before.size(), -1);
    for (size_t i = 0; i < scene.body.size(); ++i) {
      if (scene.body.x[i][axis] > low + layer) continue;
      int& type = held[scene.body.type[i]];
      if (type < 0) {
        type = static_cast<int>(scene.rule.types.size());
        scene.rule.types.push_back(before[scene.body.type[i]]);
        scene.rule.types.back().pd = true;
        scene.rule.types.back().kp = kp;
      }
      scene.body.type[i] = static_cast<uint8_t>(type);
    }
  }
  if (kp == 0)  // a controller without gains is none
    for (ParticleType& type : scene.rule.types) type.pd = false;
  return scene;
}

}  // namespace

void check_maps(const Scene& scene) {
  if (scene.body.size() > kMostParticles)
    throw InputError(fmt::format("--maps runs a scene thousands of times: {} particles are more than {}",
                                 scene.body.size(), kMostParticles),
                     "draw them of a smaller piece");
  if (scene.pitch == 0)
    throw InputError("--maps needs a [packing]: damping and stiffness are counted in those of its bonds");
}

std::vector<StabilityMap> stability_maps(const Scene& scene, const Arch& arch, int axis, int fineness,
                                         const std::function<void(const std::string&, double)>& progress) {
  check_maps(scene);
  const Scene bare = with_parts(scene, {false, false, false, false});
  const double unit = subject_of(bare).limit.dt;
  const double stiffness = -scene.rule.law_at(0).slope(scene.pitch);
  const double critical = 2 * std::sqrt(stiffness * scene.rule.mass);
  std::vector<StabilityMap> maps;

  maps.push_back(map_of(
      {"damping", "damping, in doubles", "damping ratio", even(0, 2, fineness), Arithmetic::float64}, axis,
      fineness, unit,
      [&](double ratio) {
        Column column{bare, arch};
        column.scene.rule.damping.coefficient = ratio * critical;
        return column;
      },
      progress));
  const Scene with_pd = with_parts(scene, {false, false, false, true});
  const auto held = [&](double kp) { return Column{held_by_force(with_pd, axis, kp * stiffness), arch}; };
  maps.push_back(map_of({"pd_stiffness", "a region held by force, in doubles",
                         "kp over the stiffness of a bond", even(0, 50, fineness), Arithmetic::float64},
                        axis, fineness, unit, held, progress));
  maps.push_back(map_of({"pd_stiffness_fixed", "a region held by force, in the fixed engine",
                         "kp over the stiffness of a bond", even(0, 50, fineness), Arithmetic::fixed},
                        axis, fineness, unit, held, progress));
  maps.push_back(map_of(
      {"position_bits", "formats of positions, in the fixed engine",
       "position_frac (difference_frac: 16, or all where there are fewer)",
       even(8, 26, fineness >= 19 ? 19 : 4), Arithmetic::fixed},
      axis, fineness, unit,
      [&](double bits) {
        Column column{bare, arch};
        Widths& w = column.arch.widths;
        w.position_frac = static_cast<int>(bits);
        if (w.guard == kAutomatic) w.guard = 8;
        w.difference_frac = std::min(w.position_frac, 16);
        w.relative_velocity_frac = std::min(20, w.velocity_frac());
        w.velocity_bits = w.sum_bits = w.velocity_frac() + 1;
        return column;
      },
      progress));
  maps.push_back(map_of(
      {"strength_bits", "width of the force table, in the fixed engine", "strength_bits",
       even(8, 26, fineness >= 19 ? 19 : 4), Arithmetic::fixed},
      axis, fineness, unit,
      [&](double bits) {
        Column column{bare, arch};
        column.arch.widths.strength_bits = static_cast<int>(bits);
        return column;
      },
      progress));
  maps.push_back(map_of(
      {"strain", fmt::format("strain along {}, in doubles", "xyz"[axis]), "strain",
       even(-0.15, 0.15, fineness | 1), Arithmetic::float64},
      axis, fineness, unit,
      [&](double strain) {
        return Column{bare, arch, strain};
      },
      progress));
  return maps;
}

}  // namespace cuboct::study
