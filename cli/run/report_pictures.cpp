// SPDX-License-Identifier: MIT
#include "cli/run/report_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hw/plan/state_bounds.h"
#include "model/base/error.h"
#include "model/trace/plot.h"
#include "model/trace/render.h"

namespace cuboct {

Shots::Shots(const Loaded& loaded, const Trace& trace, const std::string& path)
    : trace_(trace), real_(trace.frames.empty()), axial_(loaded, false), whole_(loaded, true) {
  check_frames(trace, bounds_of(loaded.setup.plan), path);
  for (const RealFrame& body : trace.bodies)
    if (body.x.size() != loaded.scene.body.size())
      throw InputError(fmt::format("{} holds {} particles, the scene has {}", path, body.x.size(),
                                   loaded.scene.body.size()));
}

Frame Shots::made(size_t k, const FrameMaker& maker) const {
  if (!real_) return maker.make(trace_.frames[k]);
  return maker.make(trace_.bodies[k]);
}

std::optional<size_t> Shots::crack_onset() const {
  const auto broken = [&](size_t k) {
    return std::ranges::any_of(made(k, whole_).broken, [](auto bonds) { return bonds > 0; });
  };
  size_t whole = 0, parted = size() - 1;
  if (broken(whole) || !broken(parted)) return std::nullopt;
  while (parted - whole > 1) (broken((whole + parted) / 2) ? parted : whole) = (whole + parted) / 2;
  return parted;
}

std::string draw_frames(const Scene& scene, const std::vector<std::string>& labels,
                        const std::function<Frame(size_t)>& frame_of, std::optional<double> limit) {
  constexpr int kWidth = 1100;
  const double radius = frame_style(scene).radius;
  Vec3 lower = Vec3::Constant(INFINITY), upper = -lower;
  std::vector<double> strains;
  for (size_t n = 0; n < labels.size(); ++n) {
    const Frame frame = frame_of(n);
    for (const Vec3& one : frame.x)
      if (one.allFinite()) lower = lower.cwiseMin(one), upper = upper.cwiseMax(one);
    if (!limit)
      for (const double strain : frame.strain)
        if (std::isfinite(strain)) strains.push_back(std::abs(strain));
  }
  if (!lower.allFinite()) lower = upper = Vec3::Zero();
  if (!limit && !strains.empty()) {
    const auto end = strains.begin() + static_cast<ptrdiff_t>(strains.size() * 90 / 100);
    std::nth_element(strains.begin(), end, strains.end());
    limit = *end;
  }
  const double most = std::max(limit.value_or(0), 1e-9);
  int height = 0;
  const View view = view_of(lower - Vec3::Constant(radius), upper + Vec3::Constant(radius), kWidth, height);
  std::vector<Image> images;
  for (size_t n = 0; n < labels.size(); ++n) {
    const Frame frame = frame_of(n);
    std::vector<Vec3> x;
    std::vector<Colour> colours;
    for (size_t i = 0; i < frame.x.size(); ++i) {
      if (!frame.x[i].allFinite()) continue;
      x.push_back(frame.x[i]);
      colours.push_back(diverging(frame.strain[i] / most));
    }
    images.push_back(render(x, colours, radius, view, kWidth, height));
  }
  return plot_pictures(
      images, labels,
      fmt::format("axial strain along {}, % (colours end at the 90th percentile)", "xyz"[strain_axis(scene)]),
      100 * most);
}

}  // namespace cuboct
