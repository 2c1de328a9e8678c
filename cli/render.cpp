// SPDX-License-Identifier: MIT
#include "cli/render.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace cuboct {
namespace {

constexpr int kSamples = 3;  // per pixel and axis, against jagged edges

}  // namespace

Colour viridis(double value) {
  static constexpr Colour kAnchors[9] = {{68, 1, 84},    {71, 44, 122},  {59, 81, 139},
                                         {44, 113, 142}, {33, 144, 141}, {39, 173, 129},
                                         {92, 200, 99},  {170, 220, 50}, {253, 231, 37}};
  const double at = 8 * std::clamp(value, 0.0, 1.0);
  const int low = std::min(static_cast<int>(at), 7);
  Colour colour;
  for (int c = 0; c < 3; ++c)
    colour[c] = static_cast<uint8_t>(
        std::lround(kAnchors[low][c] + (at - low) * (kAnchors[low + 1][c] - kAnchors[low][c])));
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
  const int w = width * kSamples, h = height * kSamples;
  const double scale = view.scale * kSamples, r = radius * scale;
  std::vector<float> depth(static_cast<size_t>(w) * h, -std::numeric_limits<float>::infinity());
  std::vector<std::array<float, 3>> fine(depth.size(), {255, 255, 255});
  const Vec3 light = Vec3(-0.4, 0.7, 0.75).normalized();
  const Vec3 half = (light + Vec3(0, 0, 1)).normalized();  // between light and eye, for the highlight
  for (size_t i = 0; i < x.size(); ++i) {
    const Vec3 at = view.turn * (x[i] - view.centre) * scale;
    const double cx = w / 2.0 + at[0], cy = h / 2.0 - at[1];
    const int left = std::max(0, static_cast<int>(std::floor(cx - r)));
    const int right = std::min(w - 1, static_cast<int>(std::ceil(cx + r)));
    const int top = std::max(0, static_cast<int>(std::floor(cy - r)));
    const int bottom = std::min(h - 1, static_cast<int>(std::ceil(cy + r)));
    for (int row = top; row <= bottom; ++row)
      for (int column = left; column <= right; ++column) {
        const double dx = (column + 0.5 - cx) / r, dy = (cy - row - 0.5) / r;
        const double out = 1 - dx * dx - dy * dy;
        if (out <= 0) continue;
        const Vec3 normal(dx, dy, std::sqrt(out));
        const auto z = static_cast<float>(at[2] + r * normal[2]);
        const size_t pixel = static_cast<size_t>(row) * w + column;
        if (z <= depth[pixel]) continue;
        depth[pixel] = z;
        // Ambient and diffuse light, darker towards the rim so that neighbours stand apart, and a faint
        // highlight.
        const double lit = (0.62 + 0.58 * std::max(0.0, normal.dot(light))) * (0.62 + 0.38 * normal[2]);
        const double shine = 50 * std::pow(std::max(0.0, normal.dot(half)), 40);
        for (int c = 0; c < 3; ++c)
          fine[pixel][c] = static_cast<float>(std::min(255.0, colour[i][c] * lit + shine));
      }
  }
  Image image{width, height, std::vector<Colour>(static_cast<size_t>(width) * height)};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (int k = 0; k < kSamples * kSamples; ++k)
          sum += fine[static_cast<size_t>(row * kSamples + k / kSamples) * w + column * kSamples +
                      k % kSamples][c];
        image.pixels[static_cast<size_t>(row) * width + column][c] =
            static_cast<uint8_t>(std::lround(sum / (kSamples * kSamples)));
      }
  return image;
}

}  // namespace cuboct
