// SPDX-License-Identifier: MIT
// Solids as signed distance fields. Formulas of the primitives: I. Quilez, "Distance functions" (2D and 3D);
// the combinations and the dog-bone are as derived here.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "model/base/mat3.h"

namespace cuboct {

// An axis-aligned box, m; infinite where a solid has no end.
struct Bounds {
  Vec3 low = Vec3::Constant(-std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(std::numeric_limits<double>::infinity());
};

class Shape {
 public:
  virtual ~Shape() = default;
  // Metres, negative inside. The sign is exact. The size is the distance to the surface for primitives;
  // combinations return a lower bound of it (no part of the surface is nearer).
  virtual double distance(const Vec3& x) const = 0;
  // Holds the solid; need not be the smallest such box.
  virtual Bounds bounds() const = 0;
  // Primitives and edges that one distance looks at.
  size_t parts() const { return parts_; }

 protected:
  explicit Shape(size_t parts = 1) : parts_(parts) {}

 private:
  size_t parts_;
};

using ShapePtr = std::shared_ptr<const Shape>;

ShapePtr sphere(const Vec3& centre, double radius);
// `rounding`: radius of the edges and corners, at most half the least edge.
ShapePtr box(const Vec3& low, const Vec3& high, double rounding = 0);
// `axis`: any length but 0; `length` along it, half to each side of the centre.
ShapePtr cylinder(const Vec3& centre, const Vec3& axis, double radius, double length);
// Points nearer than `radius` to the segment.
ShapePtr capsule(const Vec3& from, const Vec3& to, double radius);
// All that lies against `normal` (outward, any length but 0) from `point`.
ShapePtr half_space(const Vec3& point, const Vec3& normal);
// A polygon in the x-y plane, simple, in either sense of rotation, centred in z with that thickness.
ShapePtr extrude(std::vector<double> x, std::vector<double> y, double thickness);

// The flat specimen of ASTM D638: length along x, width along y, thickness along z, centred at the origin.
// Between the narrow section and the tabs an arc of `fillet_radius` starts tangent to the narrow section;
// where it meets the tab's side there is an edge, as in the standard. Needs narrow_width < width and
// fillet_radius >= half their difference.
struct DogBone {
  double length = 0, width = 0, thickness = 0;  // m, overall
  double narrow_length = 0, narrow_width = 0;   // m, of the parallel section
  double fillet_radius = 0;                     // m
  // Length along x of one fillet: sqrt(R^2 - (R - h)^2) with h = (width - narrow_width)/2.
  double fillet_length() const;
};
ShapePtr dog_bone(const DogBone& bone);

ShapePtr unite(std::vector<ShapePtr> parts);
ShapePtr intersect(std::vector<ShapePtr> parts);
ShapePtr subtract(ShapePtr from, std::vector<ShapePtr> parts);
// x -> rotation * (scale * x) + translation; rotation is orthonormal, scale > 0.
ShapePtr transform(ShapePtr shape, double scale, const Mat3& rotation, const Vec3& translation);

}  // namespace cuboct
