// SPDX-License-Identifier: MIT
#include "model/body/geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace cuboct {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Distance of a point to a solid whose extents along independent directions are known: q[i] is the signed
// distance along direction i.
template <typename V>
double corner_distance(const V& q) {
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

struct Sphere final : Shape {
  Vec3 centre;
  double radius;
  Sphere(const Vec3& c, double r) : centre(c), radius(r) {}
  double distance(const Vec3& x) const override { return (x - centre).norm() - radius; }
  Bounds bounds() const override {
    return {centre - Vec3::Constant(radius), centre + Vec3::Constant(radius)};
  }
};

struct Box final : Shape {
  Vec3 low, high;
  double rounding;
  Box(const Vec3& l, const Vec3& h, double r) : low(l), high(h), rounding(r) {}
  double distance(const Vec3& x) const override {
    const Vec3 half = 0.5 * (high - low) - Vec3::Constant(rounding);
    return corner_distance<Vec3>((x - 0.5 * (low + high)).cwiseAbs() - half) - rounding;
  }
  Bounds bounds() const override { return {low, high}; }
};

struct Cylinder final : Shape {
  Vec3 centre, axis;
  double radius, half;
  Cylinder(const Vec3& c, const Vec3& a, double r, double l)
      : centre(c), axis(a.normalized()), radius(r), half(l / 2) {}
  double distance(const Vec3& x) const override {
    const Vec3 d = x - centre;
    const double along = d.dot(axis);
    return corner_distance<Eigen::Vector2d>({(d - along * axis).norm() - radius, std::abs(along) - half});
  }
  Bounds bounds() const override {
    const Vec3 reach =
        half * axis.cwiseAbs() + radius * (Vec3::Ones() - axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
    return {centre - reach, centre + reach};
  }
};

struct Capsule final : Shape {
  Vec3 from, to;
  double radius;
  Capsule(const Vec3& f, const Vec3& t, double r) : from(f), to(t), radius(r) {}
  double distance(const Vec3& x) const override {
    const Vec3 axis = to - from;
    const double length2 = axis.squaredNorm();
    const double t = length2 > 0 ? std::clamp((x - from).dot(axis) / length2, 0.0, 1.0) : 0.0;
    return (x - from - t * axis).norm() - radius;
  }
  Bounds bounds() const override {
    const Vec3 r = Vec3::Constant(radius);
    return {from.cwiseMin(to) - r, from.cwiseMax(to) + r};
  }
};

struct HalfSpace final : Shape {
  Vec3 point, normal;
  HalfSpace(const Vec3& p, const Vec3& n) : point(p), normal(n.normalized()) {}
  double distance(const Vec3& x) const override { return (x - point).dot(normal); }
  Bounds bounds() const override {
    Bounds b;
    for (int a = 0; a < 3; ++a) {
      if (normal[a] == 1) b.high[a] = point[a];
      if (normal[a] == -1) b.low[a] = point[a];
    }
    return b;
  }
};

struct Extrusion final : Shape {
  std::vector<double> px, py;
  double half;
  Extrusion(std::vector<double> x, std::vector<double> y, double t)
      : Shape(x.size()), px(std::move(x)), py(std::move(y)), half(t / 2) {}

  // Least distance to an edge; the sign by the parity of crossings of a ray along +x.
  double in_plane(double x, double y) const {
    double d2 = kInfinity;
    bool inside = false;
    for (size_t i = 0, j = px.size() - 1; i < px.size(); j = i++) {
      const double ex = px[j] - px[i], ey = py[j] - py[i], wx = x - px[i], wy = y - py[i];
      const double t = std::clamp((wx * ex + wy * ey) / (ex * ex + ey * ey), 0.0, 1.0);
      const double dx = wx - t * ex, dy = wy - t * ey;
      d2 = std::min(d2, dx * dx + dy * dy);
      if ((py[i] > y) != (py[j] > y) && wx < ex * wy / ey) inside = !inside;
    }
    return inside ? -std::sqrt(d2) : std::sqrt(d2);
  }
  double distance(const Vec3& x) const override {
    return corner_distance<Eigen::Vector2d>({in_plane(x[0], x[1]), std::abs(x[2]) - half});
  }
  Bounds bounds() const override {
    return {{std::ranges::min(px), std::ranges::min(py), -half},
            {std::ranges::max(px), std::ranges::max(py), half}};
  }
};

size_t parts_of(const std::vector<ShapePtr>& shapes) {
  size_t sum = 0;
  for (const ShapePtr& shape : shapes) sum += shape->parts();
  return sum;
}

struct Union final : Shape {
  std::vector<ShapePtr> members;
  explicit Union(std::vector<ShapePtr> p) : Shape(parts_of(p)), members(std::move(p)) {}
  double distance(const Vec3& x) const override {
    double least = kInfinity;
    for (const auto& part : members) least = std::min(least, part->distance(x));
    return least;
  }
  Bounds bounds() const override {
    Bounds b{Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity)};
    for (const auto& part : members) {
      const Bounds p = part->bounds();
      b.low = b.low.cwiseMin(p.low);
      b.high = b.high.cwiseMax(p.high);
    }
    return b;
  }
};

struct Intersection final : Shape {
  std::vector<ShapePtr> members;
  explicit Intersection(std::vector<ShapePtr> p) : Shape(parts_of(p)), members(std::move(p)) {}
  double distance(const Vec3& x) const override {
    double most = -kInfinity;
    for (const auto& part : members) most = std::max(most, part->distance(x));
    return most;
  }
  Bounds bounds() const override {
    Bounds b;
    for (const auto& part : members) {
      const Bounds p = part->bounds();
      b.low = b.low.cwiseMax(p.low);
      b.high = b.high.cwiseMin(p.high);
    }
    return b;
  }
};

struct Complement final : Shape {
  ShapePtr shape;
  explicit Complement(ShapePtr s) : Shape(s->parts()), shape(std::move(s)) {}
  double distance(const Vec3& x) const override { return -shape->distance(x); }
  Bounds bounds() const override { return {}; }
};

struct Transformed final : Shape {
  ShapePtr shape;
  double scale;
  Mat3 rotation;
  Vec3 translation;
  Transformed(ShapePtr s, double k, const Mat3& r, const Vec3& t)
      : Shape(s->parts()), shape(std::move(s)), scale(k), rotation(r), translation(t) {}
  double distance(const Vec3& x) const override {
    return scale * shape->distance(rotation.transpose() * (x - translation) / scale);
  }
  // Interval arithmetic: each output axis is a sum of scaled input intervals; 0 * infinity counts 0.
  Bounds bounds() const override {
    const Bounds inner = shape->bounds();
    Bounds outer{translation, translation};
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        const double factor = scale * rotation(a, b);
        if (factor == 0) continue;
        outer.low[a] += factor * (factor > 0 ? inner.low[b] : inner.high[b]);
        outer.high[a] += factor * (factor > 0 ? inner.high[b] : inner.low[b]);
      }
    }
    return outer;
  }
};

}  // namespace

ShapePtr sphere(const Vec3& centre, double radius) { return std::make_shared<Sphere>(centre, radius); }
ShapePtr box(const Vec3& low, const Vec3& high, double rounding) {
  return std::make_shared<Box>(low, high, rounding);
}
ShapePtr cylinder(const Vec3& centre, const Vec3& axis, double radius, double length) {
  return std::make_shared<Cylinder>(centre, axis, radius, length);
}
ShapePtr capsule(const Vec3& from, const Vec3& to, double radius) {
  return std::make_shared<Capsule>(from, to, radius);
}
ShapePtr half_space(const Vec3& point, const Vec3& normal) {
  return std::make_shared<HalfSpace>(point, normal);
}
ShapePtr extrude(std::vector<double> x, std::vector<double> y, double thickness) {
  return std::make_shared<Extrusion>(std::move(x), std::move(y), thickness);
}
ShapePtr unite(std::vector<ShapePtr> parts) { return std::make_shared<Union>(std::move(parts)); }
ShapePtr intersect(std::vector<ShapePtr> parts) { return std::make_shared<Intersection>(std::move(parts)); }
ShapePtr subtract(ShapePtr from, std::vector<ShapePtr> parts) {
  std::vector<ShapePtr> all{std::move(from)};
  for (auto& part : parts) all.push_back(std::make_shared<Complement>(std::move(part)));
  return intersect(std::move(all));
}
ShapePtr transform(ShapePtr shape, double scale, const Mat3& rotation, const Vec3& translation) {
  return std::make_shared<Transformed>(std::move(shape), scale, rotation, translation);
}

double DogBone::fillet_length() const {
  const double below = fillet_radius - (width - narrow_width) / 2;
  return std::sqrt(fillet_radius * fillet_radius - below * below);
}

// The overall bar less one notch per side. All points of a notch are those nearer than R to the segment that
// the fillet's centre would sweep along the narrow section: the segment's straight part cuts the narrow
// section's side, its round ends cut the fillets. The centre stands outside the bar as R is at least the
// depth of the notch.
ShapePtr dog_bone(const DogBone& bone) {
  const Vec3 half{bone.length / 2, bone.width / 2, bone.thickness / 2};
  std::vector<ShapePtr> notches;
  for (double side : {-1.0, 1.0}) {
    const double centre = side * (bone.narrow_width / 2 + bone.fillet_radius);
    // As cylinders in z the notches reach through the thickness: a capsule's round caps in z would not.
    const double through = 2 * bone.thickness;
    for (double end : {-1.0, 1.0})
      notches.push_back(
          cylinder({end * bone.narrow_length / 2, centre, 0}, Vec3::UnitZ(), bone.fillet_radius, through));
    const Vec3 corner{bone.narrow_length / 2, bone.fillet_radius, through / 2};
    const Vec3 middle{0, centre, 0};
    notches.push_back(box(middle - corner, middle + corner));
  }
  return subtract(box(-half, half), std::move(notches));
}

}  // namespace cuboct
