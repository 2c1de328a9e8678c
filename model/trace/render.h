// SPDX-License-Identifier: MIT
// Pictures of particles: shaded spheres in parallel projection, hidden surfaces by a depth buffer.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/base/mat3.h"

namespace cuboct {

using Colour = std::array<uint8_t, 3>;

struct Image {
  int width = 0, height = 0;
  std::vector<Colour> pixels;  // rows from the top
};

// Of signed quantities: blue below zero, grey at it, red above. Colours between go in straight lines.
struct Anchor {
  double at;  // -1 ... 1
  Colour colour;
};
inline constexpr std::array<Anchor, 7> kDiverging{{{-1, {8, 48, 107}},
                                                   {-0.6, {33, 113, 181}},
                                                   {-0.25, {158, 202, 225}},
                                                   {0, {232, 232, 232}},
                                                   {0.25, {253, 174, 107}},
                                                   {0.6, {230, 85, 13}},
                                                   {1, {127, 0, 0}}}};
// -1 ... 1 to colour, clamped.
Colour diverging(double value);

struct View {
  Mat3 turn = Mat3::Identity();  // rows: right, up, towards the eye
  Vec3 centre = Vec3::Zero();    // m, in the middle of the picture
  double scale = 1;              // pixels per metre
};

// The view that shows the box [lower, upper] with its longest axis to the right, seen from above and aside,
// in a picture of `width`; the height that it needs goes to `height`.
View view_of(const Vec3& lower, const Vec3& upper, int width, int& height);

// One sphere per particle on white.
Image render(const std::vector<Vec3>& x, const std::vector<Colour>& colour, double radius, const View& view,
             int width, int height);

}  // namespace cuboct
