// SPDX-License-Identifier: MIT
#include "hw/plan/reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "model/analysis/motion_reach.h"
#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/rules/rounds_rule.h"
#include "model/scene/auto_margin.h"

namespace cuboct {
namespace {

// Cells first ... last of a row along x.
struct Span {
  int32_t first, last;
};

// A union of spans. Those of one crystal row come in order: they grow the latest span, and few are kept.
class Spans {
 public:
  void add(Span span) {
    if (!spans_.empty()) {
      Span& latest = spans_.back();
      if (span.first <= latest.last + 1 && span.last >= latest.first - 1) {
        latest = {std::min(latest.first, span.first), std::max(latest.last, span.last)};
        return;
      }
    }
    if (spans_.size() >= kept_) {
      settle();
      kept_ = std::max(kept_, 2 * spans_.size());
    }
    spans_.push_back(span);
  }
  const std::vector<Span>& settle() {
    std::sort(spans_.begin(), spans_.end(), [](Span a, Span b) { return a.first < b.first; });
    size_t n = 0;
    for (const Span& span : spans_)
      if (n > 0 && span.first <= spans_[n - 1].last + 1)
        spans_[n - 1].last = std::max(spans_[n - 1].last, span.last);
      else
        spans_[n++] = span;
    spans_.resize(n);
    return spans_;
  }

 private:
  std::vector<Span> spans_;
  size_t kept_ = 16;
};

// A union of boxes of cells. Boxes of the same rows are one entry: neighbouring particles mostly have the
// same.
class Reach {
 public:
  Reach(const CellEdges& edges, const Vec3& origin, const Cell& period)
      : edges_(edges), origin_(origin), period_(period) {}

  // Every cell that the box touches. 0, or how many those would be: more than can be built, infinite beyond
  // all numbers.
  double add(const Vec3& low, const Vec3& high) {
    double count = 1;
    std::array<Span, 3> box;
    for (int a = 0; a < 3; ++a) {
      const double first = std::floor((low[a] - origin_[a]) / edges_[a]),
                   last = std::floor((high[a] - origin_[a]) / edges_[a]);
      const int32_t ring = period_[a];
      count *= ring > 0 ? std::min(last - first + 1, static_cast<double>(ring)) : last - first + 1;
      if (ring > 0 && last - first + 1 >= ring) {
        box[a] = {0, ring - 1};
      } else if (ring > 0) {
        const auto begin = static_cast<int32_t>(first - std::floor(first / ring) * ring);
        box[a] = {begin, begin + static_cast<int32_t>(last - first)};
      } else {
        if (!(std::max(std::abs(first), std::abs(last)) < 1e9))
          return std::numeric_limits<double>::infinity();
        box[a] = {static_cast<int32_t>(first), static_cast<int32_t>(last)};
      }
    }
    if (!(count < kMostCells)) return count;
    const Rows rows{box[2].first, box[2].last, box[1].first, box[1].last};
    if (latest_ == nullptr || rows != latest_->first) latest_ = &*boxes_.try_emplace(rows).first;
    latest_->second.add(box[0]);
    return 0;
  }

  // None where there would be more than can be built; `count` of them.
  std::optional<std::vector<Cell>> cells(uint64_t& count) {
    std::vector<RowSpan> spans;
    size_t kept = size_t{1} << 20;
    for (auto& [rows, along_x] : boxes_)
      for (const Span& span : along_x.settle())
        for (int32_t z = rows[0]; z <= rows[1]; ++z)
          for (int32_t y = rows[2]; y <= rows[3]; ++y) {
            add(spans, z, y, span);
            if (spans.size() < kept) continue;
            count = settle(spans);
            if (static_cast<double>(count) > kMostCells) return std::nullopt;
            kept = std::max(kept, 2 * spans.size());
          }
    count = settle(spans);
    if (static_cast<double>(count) > kMostCells) return std::nullopt;
    boxes_.clear();
    latest_ = nullptr;
    std::vector<Cell> cells;
    cells.reserve(count);
    for (const RowSpan& row : spans)
      for (int32_t x = row.x.first; x <= row.x.last; ++x) cells.push_back({x, row.y, row.z});
    return cells;
  }

 private:
  using Rows = std::array<int32_t, 4>;  // first and last z, first and last y
  struct HashOfRows {
    size_t operator()(const Rows& rows) const {
      Hash hash;
      for (const int32_t r : rows) hash.add(r);
      return hash.value();
    }
  };
  struct RowSpan {
    int32_t z, y;
    Span x;
  };

  // A ring is opened at 0: a span that passes it falls in two.
  void add(std::vector<RowSpan>& spans, int32_t z, int32_t y, Span x) const {
    if (period_[2] > 0) z %= period_[2];
    if (period_[1] > 0) y %= period_[1];
    const int32_t ring = period_[0];
    if (ring == 0 || x.last < ring) {
      spans.push_back({z, y, x});
    } else if (x.last - x.first >= ring - 1) {
      spans.push_back({z, y, {0, ring - 1}});
    } else {
      spans.push_back({z, y, {x.first, ring - 1}});
      spans.push_back({z, y, {0, x.last - ring}});
    }
  }

  // Sorts and joins; the number of cells.
  uint64_t settle(std::vector<RowSpan>& spans) const {
    std::sort(spans.begin(), spans.end(), [](const RowSpan& a, const RowSpan& b) {
      return std::tie(a.z, a.y, a.x.first) < std::tie(b.z, b.y, b.x.first);
    });
    uint64_t count = 0;
    size_t n = 0;
    for (const RowSpan& row : spans) {
      RowSpan* last = n > 0 ? &spans[n - 1] : nullptr;
      if (last && last->z == row.z && last->y == row.y && row.x.first <= last->x.last + 1) {
        count += static_cast<uint64_t>(std::max(row.x.last, last->x.last) - last->x.last);
        last->x.last = std::max(row.x.last, last->x.last);
      } else {
        count += static_cast<uint64_t>(row.x.last - row.x.first + 1);
        spans[n++] = row;
      }
    }
    spans.resize(n);
    return count;
  }

  CellEdges edges_;
  Vec3 origin_;
  Cell period_;
  std::unordered_map<Rows, Spans, HashOfRows> boxes_;
  std::pair<const Rows, Spans>* latest_ = nullptr;
};

double stops_of(const Vec3& displacement, double edge) {
  return 1 + std::ceil(displacement.norm() / (0.5 * edge));
}

// Whether a box that moves by `displacement` touches all of the box around its first and its last place.
bool sweeps_a_box(const Vec3& displacement) { return std::ranges::count(displacement, 0.0) >= 2; }

// Refuses paths that take too long to follow. Whether there are paths.
bool check_paths(const Scene& scene, double edge, const Cell& period) {
  constexpr double kMostStops = 5e6;  // some seconds
  const double duration = scene.planned_duration();
  std::vector<double> moved(scene.rule.types.size(), 0);  // by type, its particles
  for (const uint8_t type : scene.body.type) ++moved[type];
  double stops = 0;
  bool any = false;
  for (size_t t = 0; t < moved.size(); ++t) {
    const Vec3 displacement = scene.rule.types[t].velocity * duration;
    Vec3 open = displacement;
    for (int a = 0; a < 3; ++a)
      if (period[a] > 0) open[a] = 0;
    if (moved[t] == 0 || displacement.isZero(0)) continue;
    any = true;
    if (!sweeps_a_box(displacement)) stops += moved[t] * stops_of(displacement, edge);
    if (open.norm() / edge > kMostCells || stops > kMostStops)
      scene.places.fail(
          {"run.duration", "run.steps"},
          fmt::format(
              "a body moved at {:.4g} m/s goes {:.4g} m in {:.4g} s, through {:.3g} cells of {:.4g} m: more "
              "than can be built",
              scene.rule.types[t].velocity.norm(), displacement.norm(), duration, displacement.norm() / edge,
              edge),
          "a shorter run, or one in which bodies are moved less far");
  }
  return any;
}

}  // namespace

std::vector<Cell> reachable_cells(const Scene& scene, const CellEdges& edges, const Vec3& origin,
                                  const Cell& period, int axes) {
  const double edge = edges.longest;
  Vec3 margin = scene.reach_margin.minCoeff() < 0 ? Vec3(Vec3::Constant(edge)) : scene.reach_margin;
  // A point in the middle of the layer stands for its whole height.
  const auto layer = [&](Vec3 x) {
    if (axes == 2) x.z() = origin.z() + 0.5 * edges[2];
    return x;
  };
  const bool automatic = has_auto_margin(scene);
  if (automatic && !moves(scene.rule)) margin = Vec3::Zero();
  if (axes == 2) margin.z() = 0;
  const double duration = scene.planned_duration();
  Reach reach(edges, origin, period);
  const auto refuse = [&](const std::vector<std::string>& causes, const std::string& what, double count,
                          const std::string& hint) {
    if (std::isinf(count))
      scene.places.fail(causes, fmt::format("{} more than 1e+09 cells of {:.4g} m away", what, edge), hint);
    scene.places.fail(causes,
                      fmt::format("{} {:.3g} cells of {:.4g} m: at most {:.3g} can be built", what, count,
                                  edge, kMostCells),
                      hint);
  };
  const std::vector<std::string> run{"run.duration", "run.steps"};
  const std::string shorter = "a shorter run, or one in which bodies are moved less far";
  const bool moved = check_paths(scene, edge, period);
  const bool led = automatic && moves(scene.rule);
  const MotionReach motion = led ? motion_reach(scene) : MotionReach{};
  for (size_t id = 0; id < scene.body.size(); ++id) {
    const Vec3& x = scene.body.x[id];
    const ParticleType& type = scene.rule.types[scene.body.type[id]];
    const Vec3 displacement = type.velocity * duration;
    Ranges around{-margin, margin};
    if (led) {
      const Ranges more = motion.pieces[motion.piece[id]].of(x, type);
      around = {around.low + more.low, around.high + more.high};
    }
    // Along one axis all between the ends is touched.
    const bool swept = sweeps_a_box(displacement);
    const auto stops = swept ? int64_t{1} : static_cast<int64_t>(stops_of(displacement, edge));
    for (int64_t k = swept ? 1 : 0; k <= stops; ++k) {
      const Vec3 at =
          swept ? x : Vec3(x + displacement * static_cast<double>(k) / static_cast<double>(stops));
      const Vec3 to = swept ? Vec3(x + displacement) : at;
      const double count =
          reach.add(layer(at.cwiseMin(to) + around.low), layer(at.cwiseMax(to) + around.high));
      if (count == 0) continue;
      if (displacement.isZero(0) && automatic && !std::isinf(count))
        refuse({"reach.margin"}, "the motion of a particle spans", count,
               "a shorter run, or reach.margin in lengths");
      if (displacement.isZero(0))
        refuse({std::isinf(count) ? "particle" : "reach.margin"},
               std::isinf(count) ? fmt::format("particle {} is", id) : "the reach of a particle spans", count,
               std::isinf(count) ? "particles nearer to one another" : "a smaller reach.margin");
      refuse(run, fmt::format("a body that is moved by {:.4g} m reaches", displacement.norm()), count,
             shorter);
    }
  }
  // Displacements count from the packing, wherever the run begins.
  if (scene.packed)
    for (const Vec3& x : scene.packed->x) reach.add(layer(x - margin), layer(x + margin));
  if (scene.reach[0] != scene.reach[1])
    if (const double count = reach.add(layer(scene.reach[0]), layer(scene.reach[1])); count > 0)
      refuse({"reach.max", "reach.min"}, "the reach box spans", count, "a smaller reach box");
  uint64_t count = 0;
  auto cells = reach.cells(count);
  if (!cells)
    refuse(moved ? run : std::vector<std::string>{"reach.margin", "geometry", "box"}, "the body can reach",
           static_cast<double>(count),
           moved       ? shorter
           : automatic ? "a shorter run, or reach.margin in lengths"
                       : "a smaller body, or a smaller reach.margin");
  return std::move(*cells);
}

}  // namespace cuboct
