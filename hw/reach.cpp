// SPDX-License-Identifier: MIT
#include "hw/reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "model/error.h"
#include "model/hash.h"

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
  Reach(double edge, const Vec3& origin, const Cell& period)
      : edge_(edge), origin_(origin), period_(period) {}

  // Every cell that the box touches.
  void add(const Vec3& low, const Vec3& high) {
    double count = 1;
    for (int a = 0; a < 3; ++a) count *= (high[a] - low[a]) / edge_ + 1;
    if (!(count < kMostCells) || !((high - origin_).cwiseAbs().maxCoeff() < 1e9 * edge_) ||
        !((low - origin_).cwiseAbs().maxCoeff() < 1e9 * edge_))
      throw InputError(fmt::format("the reach spans {:.3g} cells of {:.4g} m: at most {:.3g} can be built",
                                   count, edge_, kMostCells),
                       "a smaller reach.margin or reach box");
    std::array<Span, 3> box;
    for (int a = 0; a < 3; ++a) {
      box[a] = {static_cast<int32_t>(std::floor((low[a] - origin_[a]) / edge_)),
                static_cast<int32_t>(std::floor((high[a] - origin_[a]) / edge_))};
      if (const int32_t ring = period_[a]; ring > 0) {
        const int32_t first = (box[a].first % ring + ring) % ring;
        box[a] = {first, first + std::min(box[a].last - box[a].first, ring - 1)};
      }
    }
    const Rows rows{box[2].first, box[2].last, box[1].first, box[1].last};
    if (latest_ == nullptr || rows != latest_->first) latest_ = &*boxes_.try_emplace(rows).first;
    latest_->second.add(box[0]);
  }

  std::vector<Cell> cells() {
    std::vector<RowSpan> spans;
    size_t kept = size_t{1} << 20;
    for (auto& [rows, along_x] : boxes_)
      for (const Span& span : along_x.settle())
        for (int32_t z = rows[0]; z <= rows[1]; ++z)
          for (int32_t y = rows[2]; y <= rows[3]; ++y) {
            add(spans, z, y, span);
            if (spans.size() < kept) continue;
            settle(spans);
            kept = std::max(kept, 2 * spans.size());
          }
    const uint64_t count = settle(spans);
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
    if (static_cast<double>(count) > kMostCells)
      throw InputError(fmt::format("the body can reach {} cells of {:.4g} m: at most {:.3g} can be built",
                                   count, edge_, kMostCells));
    return count;
  }

  double edge_;
  Vec3 origin_;
  Cell period_;
  std::unordered_map<Rows, Spans, HashOfRows> boxes_;
  std::pair<const Rows, Spans>* latest_ = nullptr;
};

}  // namespace

std::vector<Cell> reachable_cells(const Scene& scene, double edge, const Vec3& origin, const Cell& period,
                                  int axes) {
  Vec3 margin = scene.reach_margin.minCoeff() < 0 ? Vec3(Vec3::Constant(edge)) : scene.reach_margin;
  // A point in the middle of the layer stands for its whole height.
  const auto layer = [&](Vec3 x) {
    if (axes == 2) x.z() = origin.z() + 0.5 * edge;
    return x;
  };
  if (axes == 2) margin.z() = 0;
  const double duration = static_cast<double>(scene.steps) * scene.rule.dt;
  Reach reach(edge, origin, period);
  for (size_t id = 0; id < scene.body.size(); ++id) {
    const Vec3& x = scene.body.x[id];
    const Vec3& velocity = scene.rule.types[scene.body.type[id]].velocity;
    if (velocity.isZero(0)) {
      reach.add(layer(x - margin), layer(x + margin));
      continue;
    }
    const Vec3 way = velocity * duration;
    const int stops = 1 + static_cast<int>(std::ceil(way.norm() / (0.5 * edge)));
    for (int k = 0; k <= (way.norm() > 0 ? stops : 0); ++k) {
      const Vec3 at = x + way * k / stops;
      reach.add(layer(at - margin), layer(at + margin));
    }
  }
  if (scene.reach[0] != scene.reach[1]) reach.add(layer(scene.reach[0]), layer(scene.reach[1]));
  return reach.cells();
}

}  // namespace cuboct
