// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/body/regions.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

constexpr double kPi = std::numbers::pi;

class Points {
 public:
  explicit Points(uint64_t seed) : generator_(seed) {}
  Vec3 in(const Vec3& low, const Vec3& high) {
    Vec3 x;
    for (int a = 0; a < 3; ++a)
      x[a] = low[a] + (high[a] - low[a]) * static_cast<double>(generator_() >> 11) * 0x1p-53;
    return x;
  }

 private:
  std::mt19937_64 generator_;
};

// Monte Carlo over a box: expects the volume within five standard deviations.
void expect_volume(const Shape& shape, double volume) {
  const Bounds b = shape.bounds();
  const Vec3 pad = 0.1 * (b.high - b.low);
  const double whole = (1.2 * (b.high - b.low)).prod();
  constexpr int kDraws = 200000;
  Points points(1);
  int inside = 0;
  for (int i = 0; i < kDraws; ++i) inside += shape.distance(points.in(b.low - pad, b.high + pad)) < 0;
  const double p = volume / whole;
  EXPECT_NEAR(inside, p * kDraws, 5 * std::sqrt(p * (1 - p) * kDraws));
}

// Where the field is a distance, two points' values differ by no more than the points do; and nothing inside
// lies outside the bounds.
void expect_lipschitz_and_bounded(const Shape& shape) {
  const Bounds b = shape.bounds();
  const Vec3 pad = b.high - b.low;
  Points points(2);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 x = points.in(b.low - pad, b.high + pad), y = points.in(b.low - pad, b.high + pad);
    EXPECT_LE(std::abs(shape.distance(x) - shape.distance(y)), (x - y).norm() * (1 + 1e-12));
    if (shape.distance(x) < 0) {
      EXPECT_TRUE(x.within(b.low, b.high)) << x;
    }
  }
}

TEST(Geometry, VolumesMatchClosedForms) {
  expect_volume(*sphere({1, 2, 3}, 2), 4.0 / 3 * kPi * 8);
  expect_volume(*box({0, 0, 0}, {1, 2, 3}), 6);
  // Steiner: the inner box grown by r.
  const double a = 1.2, b = 2.2, c = 3.2, r = 0.4;
  expect_volume(*box({0, 0, 0}, {2, 3, 4}, r), a * b * c + 2 * r * (a * b + b * c + c * a) +
                                                   kPi * r * r * (a + b + c) + 4.0 / 3 * kPi * r * r * r);
  expect_volume(*cylinder({0, 1, 0}, {1, 1, 1}, 1.5, 4), kPi * 2.25 * 4);
  expect_volume(*capsule({0, 0, 0}, {3, 0, 4}, 1), kPi * 5 + 4.0 / 3 * kPi);
  expect_volume(*extrude({0, 4, 4, 2, 0}, {0, 0, 3, 1, 3}, 2),
                2 * (4 * 3 - 0.5 * 4 * 2));  // a square less a notch
  expect_volume(*extrude({0, 2, 4, 4, 0}, {3, 1, 3, 0, 0}, 2), 2 * (4 * 3 - 0.5 * 4 * 2));  // the other sense
}

TEST(Geometry, FieldsAreLipschitz) {
  for (const ShapePtr& shape :
       {sphere({1, 2, 3}, 2), box({0, 0, 0}, {1, 2, 3}, 0.2), cylinder({0, 1, 0}, {1, 1, 1}, 1.5, 4),
        capsule({0, 0, 0}, {3, 0, 4}, 1), extrude({0, 4, 4, 2, 0}, {0, 0, 3, 1, 3}, 2),
        subtract(box({0, 0, 0}, {4, 4, 4}), {sphere({2, 2, 4}, 1.5)}),
        transform(box({0, 0, 0}, {1, 2, 3}), 2,
                  Eigen::AngleAxisd(0.7, eigen(Vec3(1, 2, 3).normalized())).toRotationMatrix(), {5, 6, 7})})
    expect_lipschitz_and_bounded(*shape);
}

TEST(Geometry, DistancesAtKnownPoints) {
  const auto b = box({0, 0, 0}, {2, 2, 2});
  EXPECT_DOUBLE_EQ(b->distance({1, 1, 1}), -1);
  EXPECT_DOUBLE_EQ(b->distance({1, 1, 3}), 1);
  EXPECT_DOUBLE_EQ(b->distance({3, 3, 3}), std::sqrt(3));
  const auto c = cylinder({0, 0, 0}, {0, 0, 2}, 1, 4);
  EXPECT_DOUBLE_EQ(c->distance({4, 0, 6}), 5);
  EXPECT_DOUBLE_EQ(half_space({0, 0, 1}, {0, 0, 3})->distance({5, 5, 4}), 3);
  EXPECT_DOUBLE_EQ(extrude({0, 4, 4, 0}, {0, 0, 4, 4}, 2)->distance({7, 8, 0}), 5);
  const auto moved =
      transform(sphere({1, 0, 0}, 1), 2, Eigen::AngleAxisd(kPi / 2, eigen(Vec3::UnitZ())).toRotationMatrix(),
                {0, 0, 5});
  EXPECT_NEAR(moved->distance({0, 2, 5}), -2, 1e-15);  // the centre: (1,0,0) -> (2,0,0) -> (0,2,0) -> (0,2,5)
}

TEST(Geometry, CombinationsFollowSetAlgebra) {
  const auto a = sphere({0, 0, 0}, 1), b = box({-0.2, -2, -0.5}, {2, 0.7, 2});
  const auto u = unite({a, b}), i = intersect({a, b}), d = subtract(a, {b});
  Points points(3);
  int in_u = 0, in_i = 0, in_d = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 x = points.in({-2, -2, -2}, {2, 2, 2});
    const bool in_a = a->distance(x) < 0, in_b = b->distance(x) < 0;
    EXPECT_EQ(u->distance(x) < 0, in_a || in_b);
    EXPECT_EQ(i->distance(x) < 0, in_a && in_b);
    EXPECT_EQ(d->distance(x) < 0, in_a && !in_b);
    in_u += in_a || in_b;
    in_i += in_a && in_b;
    in_d += in_a && !in_b;
  }
  EXPECT_GT(std::min({in_u, in_i, in_d}), 200);  // each case was drawn
}

// Plane area of the dog-bone: the bar less, on each side, the straight notch and two fillets. One fillet
// takes, under its tangent line's height h, the area w*R - (sector and triangle of the arc): with the arc's
// angle t = acos(1 - h/R), w = R sin t, the arc y = R - sqrt(R^2 - x^2) bounds the notch from below, so a
// fillet's notch is w*h - integral_0^w (R - sqrt(R^2 - x^2)) dx = w*h - w*R + (w*sqrt(R^2 - w^2) + R^2 t)/2.
TEST(Geometry, DogBone) {
  DogBone bone{.length = 63.5,
               .width = 9.53,
               .thickness = 3.2,
               .narrow_length = 9.53,
               .narrow_width = 3.18,
               .fillet_radius = 12.7};
  const auto shape = dog_bone(bone);
  const double h = (bone.width - bone.narrow_width) / 2, r = bone.fillet_radius, t = std::acos(1 - h / r);
  const double w = r * std::sin(t);
  EXPECT_NEAR(bone.fillet_length(), w, 1e-12);
  const double fillet = w * h - w * r + (w * std::sqrt(r * r - w * w) + r * r * t) / 2;
  const double area = bone.length * bone.width - 2 * (bone.narrow_length * h + 2 * fillet);
  expect_volume(*shape, area * bone.thickness);
  expect_lipschitz_and_bounded(*shape);
  // On the narrow side, on the arc half way up, on the tab.
  EXPECT_NEAR(shape->distance({0, 1.59, 0}), 0, 1e-12);
  EXPECT_NEAR(shape->distance({9.53 / 2 + r * std::sin(0.3), 1.59 + r * (1 - std::cos(0.3)), 1}), 0, 1e-12);
  EXPECT_NEAR(shape->distance({20, 9.53 / 2, 1}), 0, 1e-12);
  EXPECT_LT(shape->distance({9.53 / 2 + w + 0.01, 9.53 / 2 - 0.001, 0}), 0);
  EXPECT_GT(shape->distance({9.53 / 2 + w - 0.01, 9.53 / 2 - 0.001, 0}), 0);
}

// The shape `g`.
ShapePtr read(const std::string& text) {
  const ConfigTable root = parse_config(text, "a.toml");
  const Regions regions(root);
  return read_shape(root.at("g"), regions);
}

std::string error_of(const std::string& text) {
  return refused_with([&] { read(text); });
}

TEST(Geometry, ReadsNestedShapes) {
  const auto shape = read(R"(
[g]
shape = "difference"
from = { shape = "box", size = "[4, 4, 4] mm" }
minus = [ { shape = "cylinder", axis = "z", radius = "1 mm", length = "5 mm" },
          { shape = "sphere", centre = "[2, 2, 2] mm", radius = "1 mm" } ]
scale = 2.0
rotate = { axis = [0, 0, 1], angle = "90 deg" }
translate = "[1, 0, 0] m"
)");
  EXPECT_GT(shape->distance({1, 0, 0}), 0);                     // in the bore
  EXPECT_LT(shape->distance({1.003, 0, 0}), 0);                 // in the wall
  EXPECT_GT(shape->distance({1 - 0.0039, 0.0039, 0.0039}), 0);  // the corner cut: (+,+,+) turned to (-,+,+)
  EXPECT_LT(shape->distance({1.0039, 0.0039, 0.0039}), 0);
}

TEST(Geometry, RefusesBadShapes) {
  EXPECT_EQ(error_of("[g]\nshape = \"bx\"\n"), "a.toml:2:9: unknown shape 'bx'\n  hint: did you mean 'box'?");
  EXPECT_EQ(error_of("[g]\nshape = \"torus\"\n"),
            "a.toml:2:9: unknown shape 'torus'\n  hint: known: sphere, box, cylinder, capsule, half_space, "
            "extrude, "
            "astm_d638, mesh, union, intersection or difference");
  EXPECT_EQ(error_of("[g]\nshape = \"sphere\"\n"), "a.toml:1:1: missing key 'radius' in 'g'");
  EXPECT_EQ(error_of("[g]\nshape = \"sphere\"\nradius = \"1 mm\"\nradios = 3\n"),
            "a.toml:4:1: unknown key 'radios'");
  EXPECT_EQ(error_of("[g]\nshape = \"box\"\nmin = \"[0, 0, 0] m\"\nmax = \"[1, 0, 1] m\"\n"),
            "a.toml:4:7: 'max' must be above 'min' along y");
  EXPECT_EQ(error_of("g = { shape = \"union\", of = [ { shape = \"sphere\", radius = 3 } ] }\n"),
            "a.toml:1:60: 'radius' needs a unit: a length such as \"3 mm\"");
  EXPECT_EQ(error_of("[g]\nshape = \"half_space\"\nnormal = [0, 0, 0]\n"),
            "a.toml:3:10: 'normal' must not be zero");
  EXPECT_EQ(error_of("[g]\nshape = \"half_space\"\nnormal = \"xy\"\n"),
            "a.toml:3:10: unknown direction 'xy'\n  hint: such as \"z\", \"-x\" or three numbers: [1, 1, 0]");
  EXPECT_EQ(
      error_of("[g]\nshape = \"half_space\"\nnormal = 3\n"),
      "a.toml:3:10: 'normal' must be a direction such as \"z\", \"-x\" or [1, 1, 0], not a whole number");
  EXPECT_EQ(
      error_of("[g]\nshape = \"extrude\"\nx = \"[0, 1, 1] m\"\ny = \"[0, 0] m\"\nthickness = \"1 m\"\n"),
      "a.toml:4:5: 'x' has 3 coordinates, 'y' has 2");
}

// A half space against each way to write its normal: the depth of a point is its component along it.
TEST(Geometry, ReadsDirections) {
  const Vec3 point(1, 2, 3);
  const auto depth = [&](const std::string& normal) {
    return read("[g]\nshape = \"half_space\"\nnormal = " + normal + "\n")->distance(point);
  };
  EXPECT_EQ(depth("\"y\""), 2);
  EXPECT_EQ(depth("\"+z\""), 3);
  EXPECT_EQ(depth("\"-x\""), -1);
  EXPECT_NEAR(depth("[3, 0, -4]"), (3 - 12) / 5.0, 1e-15);
  const auto turned = read(
      "[g]\nshape = \"cylinder\"\naxis = \"-x\"\nradius = \"1 m\"\nlength = \"6 m\"\n"
      "rotate = { axis = \"-z\", angle = \"90 deg\" }\n");
  EXPECT_LT(turned->distance({0, 2.9, 0}), 0);  // along y now
  EXPECT_GT(turned->distance({2.9, 0, 0}), 0);
}

// A plate with a hole, from names: of regions before and after, placed and as they stand.
const std::string kNamed = R"([regions]
plate = { shape = "difference", from = "slab", minus = ["bore", { region = "bore", translate = "[3, 0, 0] m" }] }
slab = { shape = "box", size = "[20, 4, 1] m" }
bore = { shape = "cylinder", radius = "1 m", length = "2 m" }
same = "plate"
)";

TEST(Geometry, ShapesAreMadeOfNamedOnes) {
  for (const std::string& g :
       {"g = \"plate\"\n" + kNamed, "g = \"same\"\n" + kNamed, kNamed + "[g]\nregion = \"plate\"\n"}) {
    const auto shape = read(g);
    EXPECT_EQ(shape->parts(), 3U);
    EXPECT_GT(shape->distance({0, 0, 0}), 0);
    EXPECT_GT(shape->distance({3, 0, 0}), 0);
    EXPECT_LT(shape->distance({1.5, 0, 0}), 0);
    EXPECT_LT(shape->distance({-3, 0, 0}), 0);
  }
  const auto moved = read(kNamed + "[g]\nregion = \"plate\"\ntranslate = \"[0, 9, 0] m\"\n");
  EXPECT_GT(moved->distance({3, 9, 0}), 0);
  EXPECT_LT(moved->distance({-3, 9, 0}), 0);
}

TEST(Geometry, RefusesNamesThatLeadNowhere) {
  EXPECT_EQ(error_of("g = \"plat\"\n" + kNamed),
            "a.toml:1:5: unknown region 'plat'\n  hint: did you mean 'plate'?");
  EXPECT_EQ(error_of("g = \"plate\"\n"),
            "a.toml:1:5: unknown region 'plate'\n  hint: [regions] names shapes");
  EXPECT_EQ(error_of(kNamed + "[g]\nshape = \"slab\"\n"),
            "a.toml:7:9: unknown shape 'slab'\n  hint: of the region: region = \"slab\"");
  EXPECT_EQ(error_of(kNamed + "[g]\nregion = \"slab\"\nshape = \"box\"\n"),
            "a.toml:7:10: give 'shape' or 'region', not both");
  EXPECT_EQ(error_of("g = \"a\"\n[regions]\na = { shape = \"union\", of = [\"b\"] }\nb = { region = \"c\" }\n"
                     "c = { shape = \"difference\", from = \"b\", minus = [\"a\"] }\n"),
            "a.toml:5:36: region 'b' is made of itself: b, c, b");
  EXPECT_EQ(error_of("g = \"a\"\n[regions]\na = \"a\"\n"), "a.toml:3:5: region 'a' is made of itself: a, a");
  // Twice as many parts, and one deeper, with each line.
  std::string doubled = "[regions]\na0 = { shape = \"sphere\", radius = \"1 m\" }\n";
  for (int k = 1; k <= 60; ++k)
    doubled += fmt::format("a{0} = {{ shape = \"union\", of = [\"a{1}\", \"a{1}\"] }}\n", k, k - 1);
  EXPECT_EQ(error_of(doubled), "a.toml:22:7: region 'a20' has 1048576 parts: at most 1000000 may be");
  std::string chain = "[regions]\n";
  for (int k = 0; k < 100; ++k) chain += fmt::format("a{} = \"a{}\"\n", k, k + 1);
  EXPECT_EQ(error_of(chain), "a.toml:65:7: more than 64 regions within one another");
}

}  // namespace
}  // namespace cuboct
