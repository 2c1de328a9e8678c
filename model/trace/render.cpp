// SPDX-License-Identifier: MIT
#include "model/trace/render.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cuboct {
namespace {

constexpr int kSamples = 3;  // per pixel and axis, against jagged edges
constexpr uint32_t kNothing = 0xffffffffu;

// A sphere in the plane of the picture, in samples, and the samples that it may touch.
struct Disc {
  Vec3 at;  // of the centre: right, up, towards the eye
  double cx, cy;
  int left, right, top, bottom;
};

struct Projection {
  Projection(double metres, const View& of, int pixels_wide, int pixels_high)
      : view(of),
        scale(of.scale * kSamples),
        radius(metres * scale),
        width(pixels_wide * kSamples),
        height(pixels_high * kSamples) {}

  Disc disc(const Vec3& x) const {
    Disc disc;
    disc.at = view.turn * (x - view.centre) * scale;
    disc.cx = width / 2.0 + disc.at[0];
    disc.cy = height / 2.0 - disc.at[1];
    disc.left = std::max(0, static_cast<int>(std::floor(disc.cx - radius)));
    disc.right = std::min(width - 1, static_cast<int>(std::ceil(disc.cx + radius)));
    disc.top = std::max(0, static_cast<int>(std::floor(disc.cy - radius)));
    disc.bottom = std::min(height - 1, static_cast<int>(std::ceil(disc.cy + radius)));
    return disc;
  }
  // Of the sphere where the sample sees it.
  std::optional<Vec3> normal(const Disc& disc, int column, int row) const {
    const double dx = (column + 0.5 - disc.cx) / radius, dy = (disc.cy - row - 0.5) / radius;
    const double out = 1 - dx * dx - dy * dy;
    if (out <= 0) return std::nullopt;
    return Vec3(dx, dy, std::sqrt(out));
  }

  const View& view;
  double scale;  // samples per metre
  double radius;
  int width, height;  // samples
};

// Ambient and diffuse light, darker towards the rim so that neighbours stand apart, and a faint highlight.
std::array<float, 3> shaded(const Colour& colour, const Vec3& normal) {
  static const Vec3 light = Vec3(-0.4, 0.7, 0.75).normalized();
  static const Vec3 half = (light + Vec3(0, 0, 1)).normalized();  // between light and eye
  const double lit = (0.62 + 0.58 * std::max(0.0, normal.dot(light))) * (0.62 + 0.38 * normal[2]);
  const double shine = 50 * std::pow(std::max(0.0, normal.dot(half)), 40);
  std::array<float, 3> seen;
  for (size_t c = 0; c < 3; ++c) seen[c] = static_cast<float>(std::min(255.0, colour[c] * lit + shine));
  return seen;
}

// How near to the eye each tile of samples is covered whole by one sphere: of a solid body of millions all
// but the surface is hidden behind that, and need not be drawn.
class Cover {
 public:
  Cover(const std::vector<Vec3>& x, const Projection& projection)
      : radius_(projection.radius),
        tile_(std::max(1, static_cast<int>(radius_ / 2))),
        columns_(projection.width / tile_ + 1),
        depth_(static_cast<size_t>(columns_) * static_cast<size_t>(projection.height / tile_ + 1),
               -std::numeric_limits<double>::infinity()) {
    for (const Vec3& one : x) {
      const Disc disc = projection.disc(one);
      // Tiles whose farthest corner is still within the disc: there the sphere's surface is at least this
      // near.
      for (int row = disc.top / tile_; row <= disc.bottom / tile_; ++row)
        for (int column = disc.left / tile_; column <= disc.right / tile_; ++column) {
          const double dx = farthest(disc.cx, column * tile_), dy = farthest(disc.cy, row * tile_);
          const double out = radius_ * radius_ - dx * dx - dy * dy;
          double& depth = depth_[static_cast<size_t>(row) * static_cast<size_t>(columns_) + column];
          if (out > 0) depth = std::max(depth, disc.at[2] + std::sqrt(out));
        }
    }
  }

  // Whether no sample can see the sphere. Depths are compared as floats in the end, hence the margin.
  bool hides(const Disc& disc) const {
    const double nearest = disc.at[2] + radius_ + 1e-3 * radius_ + 1e-6 * std::abs(disc.at[2]);
    for (int row = disc.top / tile_; row <= disc.bottom / tile_; ++row)
      for (int column = disc.left / tile_; column <= disc.right / tile_; ++column)
        if (depth_[static_cast<size_t>(row) * static_cast<size_t>(columns_) + column] <= nearest)
          return false;
    return true;
  }

 private:
  double farthest(double centre, int first) const {
    return std::max(std::abs(centre - first), std::abs(centre - first - tile_));
  }

  double radius_;
  int tile_;  // samples along a tile's edge
  int columns_;
  std::vector<double> depth_;  // samples towards the eye
};

}  // namespace

Colour diverging(double value) {
  const double at = std::clamp(value, -1.0, 1.0);
  size_t k = 1;
  while (k + 1 < kDiverging.size() && kDiverging[k].at < at) ++k;
  const Anchor &low = kDiverging[k - 1], &high = kDiverging[k];
  const double part = (at - low.at) / (high.at - low.at);
  Colour colour;
  for (size_t c = 0; c < 3; ++c)
    colour[c] = static_cast<uint8_t>(std::lround(low.colour[c] + part * (high.colour[c] - low.colour[c])));
  return colour;
}

View view_of(const Vec3& lower, const Vec3& upper, int width, int& height) {
  const Vec3 extent = upper - lower;
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return extent[a] > extent[b]; });
  Mat3 axes = Mat3::Zero();
  axes(0, order[0]) = 1;
  axes(1, order[1]) = 1;
  axes.row(2) = axes.row(0).cross(axes.row(1));
  // Turned by 24 degrees about the vertical and tipped by 30 towards the eye, so that three faces show, then
  // rolled until the longest axis lies level again.
  const double yaw = 24 * M_PI / 180, tip = 30 * M_PI / 180;
  Mat3 about_up, about_right;
  about_up << std::cos(yaw), 0, std::sin(yaw), 0, 1, 0, -std::sin(yaw), 0, std::cos(yaw);
  about_right << 1, 0, 0, 0, std::cos(tip), -std::sin(tip), 0, std::sin(tip), std::cos(tip);
  View view;
  view.turn = about_right * about_up * axes;
  const Vec3 longest = view.turn.col(order[0]);
  const double roll = -std::atan2(longest[1], longest[0]);
  Mat3 about_eye;
  about_eye << std::cos(roll), -std::sin(roll), 0, std::sin(roll), std::cos(roll), 0, 0, 0, 1;
  view.turn = about_eye * view.turn;
  view.centre = (lower + upper) / 2;
  const Vec3 seen = view.turn.cwiseAbs() * extent;
  view.scale = 0.97 * width / seen[0];
  height = std::max(40, static_cast<int>(std::ceil(seen[1] * view.scale / 0.97)));
  return view;
}

Image render(const std::vector<Vec3>& x, const std::vector<Colour>& colour, double radius, const View& view,
             int width, int height) {
  const Projection projection(radius, view, width, height);
  const Cover cover(x, projection);
  const int w = projection.width;
  std::vector<float> depth(static_cast<size_t>(w) * static_cast<size_t>(projection.height),
                           -std::numeric_limits<float>::infinity());
  std::vector<uint32_t> front(depth.size(), kNothing);
  for (size_t i = 0; i < x.size(); ++i) {
    const Disc disc = projection.disc(x[i]);
    if (cover.hides(disc)) continue;
    for (int row = disc.top; row <= disc.bottom; ++row)
      for (int column = disc.left; column <= disc.right; ++column) {
        const auto normal = projection.normal(disc, column, row);
        if (!normal) continue;
        const auto z = static_cast<float>(disc.at[2] + projection.radius * (*normal)[2]);
        const size_t sample = static_cast<size_t>(row) * w + column;
        if (z <= depth[sample]) continue;
        depth[sample] = z;
        front[sample] = static_cast<uint32_t>(i);
      }
  }

  // What is seen is shaded only now.
  Image image{width, height, std::vector<Colour>(static_cast<size_t>(width) * height)};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      std::array<double, 3> sum{};
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const int fine_row = row * kSamples + k / kSamples, fine_column = column * kSamples + k % kSamples;
        const uint32_t i = front[static_cast<size_t>(fine_row) * w + fine_column];
        const std::array<float, 3> seen =
            i == kNothing
                ? std::array<float, 3>{255, 255, 255}
                : shaded(colour[i], *projection.normal(projection.disc(x[i]), fine_column, fine_row));
        for (size_t c = 0; c < 3; ++c) sum[c] += seen[c];
      }
      for (size_t c = 0; c < 3; ++c)
        image.pixels[static_cast<size_t>(row) * width + column][c] =
            static_cast<uint8_t>(std::lround(sum[c] / (kSamples * kSamples)));
    }
  return image;
}

}  // namespace cuboct
