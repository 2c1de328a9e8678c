// SPDX-License-Identifier: MIT
// Pictures: the renderer that leaves out what is hidden against one that draws every sphere.
#include "model/trace/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace cuboct {
namespace {

constexpr int kSamples = 3;

Image render_simply(const std::vector<Vec3>& x, const std::vector<Colour>& colour, double radius,
                    const View& view, int width, int height) {
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

struct Drawing {
  std::vector<Vec3> x;
  std::vector<Colour> colour;
};

// Spheres on a simple lattice that touch, shuffled, with a few lone ones around.
Drawing block(int n, uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<>()(random);
  };
  Drawing drawing;
  for (int k = 0; k < n * n * n; ++k)
    drawing.x.push_back(Vec3(k % n, k / n % n, k / (n * n)) + 0.05 * Vec3(uniform(-1, 1), uniform(-1, 1), 0));
  for (int k = 0; k < 20; ++k)
    drawing.x.push_back(Vec3(uniform(-3, n + 3), uniform(-3, n + 3), uniform(-3, n + 3)));
  std::shuffle(drawing.x.begin(), drawing.x.end(), random);
  for (size_t k = 0; k < drawing.x.size(); ++k) drawing.colour.push_back(diverging(uniform(-1, 1)));
  return drawing;
}

TEST(Render, LeavesOutOnlyWhatIsHidden) {
  for (const int width : {400, 150, 40, 9}) {  // spheres from 30 samples to less than one
    SCOPED_TRACE(width);
    const Drawing drawing = block(width > 150 ? 8 : 14, static_cast<uint64_t>(width));
    const double radius = 0.5;
    int height = 0;
    const View view = view_of(Vec3::Constant(-3.5), Vec3(17, 16.5, 16), width, height);
    const Image image = render(drawing.x, drawing.colour, radius, view, width, height);
    EXPECT_EQ(image.pixels, render_simply(drawing.x, drawing.colour, radius, view, width, height).pixels);
  }
}

// The eye comes so near that spheres pass the picture's edges.
TEST(Render, CutsAtTheEdges) {
  const Drawing drawing = block(8, 5);
  int height = 0;
  View view = view_of(Vec3::Zero(), Vec3::Constant(8), 120, height);
  view.scale *= 3;
  EXPECT_EQ(render(drawing.x, drawing.colour, 0.5, view, 120, height).pixels,
            render_simply(drawing.x, drawing.colour, 0.5, view, 120, height).pixels);
}

}  // namespace
}  // namespace cuboct
