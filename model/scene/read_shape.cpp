// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <functional>
#include <utility>

#include "model/base/spelling.h"
#include "model/scene/geometry.h"

namespace cuboct {
namespace {

Vec3 direction(const ConfigValue& value) {
  if (value.is_string()) {
    const size_t axis = value.choice("axis", {"x", "y", "z"});
    return Vec3::Unit(static_cast<Eigen::Index>(axis));
  }
  const Vec3 v = value.vector(quantity::number);
  if (v.norm() == 0) value.fail(fmt::format("'{}' must not be zero", value.key()));
  return v;
}

std::vector<ShapePtr> read_parts(const ConfigTable& table, const std::string& key, size_t least) {
  std::vector<ShapePtr> parts;
  for (const ConfigValue& item : table.at(key).items()) parts.push_back(read_shape(item.table()));
  if (parts.size() < least) table.at(key).fail(fmt::format("'{}' needs at least {} shapes", key, least));
  return parts;
}

ShapePtr read_sphere(const ConfigTable& t) {
  return sphere(t.vector_or("centre", quantity::length, Vec3::Zero()),
                t.number("radius", quantity::length, Range::positive()));
}

ShapePtr read_box(const ConfigTable& t) {
  t.not_both("min", "size");
  t.not_both("max", "size");
  t.not_both("min", "centre");
  Vec3 low, high;
  if (t.has("size")) {
    const Vec3 size = t.at("size").vector(quantity::length);
    if (!(size.minCoeff() > 0)) t.at("size").fail("'size' must be greater than 0 along each axis");
    const Vec3 centre = t.vector_or("centre", quantity::length, Vec3::Zero());
    low = centre - size / 2;
    high = centre + size / 2;
  } else {
    low = t.at("min").vector(quantity::length);
    high = t.at("max").vector(quantity::length);
    for (int a = 0; a < 3; ++a)
      if (!(low[a] < high[a])) t.at("max").fail(fmt::format("'max' must be above 'min' along {}", "xyz"[a]));
  }
  const double rounding = t.number_or("rounding", quantity::length, 0, Range::not_negative());
  if (2 * rounding > (high - low).minCoeff())
    t.at("rounding").fail("'rounding' must be at most half the least edge of the box");
  return box(low, high, rounding);
}

ShapePtr read_cylinder(const ConfigTable& t) {
  const auto axis = t.find("axis");
  return cylinder(t.vector_or("centre", quantity::length, Vec3::Zero()),
                  axis ? direction(*axis) : Vec3(Vec3::UnitZ()),
                  t.number("radius", quantity::length, Range::positive()),
                  t.number("length", quantity::length, Range::positive()));
}

ShapePtr read_capsule(const ConfigTable& t) {
  return capsule(t.at("from").vector(quantity::length), t.at("to").vector(quantity::length),
                 t.number("radius", quantity::length, Range::positive()));
}

ShapePtr read_half_space(const ConfigTable& t) {
  return half_space(t.vector_or("point", quantity::length, Vec3::Zero()), direction(t.at("normal")));
}

ShapePtr read_extrude(const ConfigTable& t) {
  auto x = t.at("x").numbers(quantity::length);
  auto y = t.at("y").numbers(quantity::length);
  if (x.size() < 3) t.at("x").fail("a profile needs at least 3 points");
  if (x.size() != y.size())
    t.at("y").fail(fmt::format("'x' has {} coordinates, 'y' has {}", x.size(), y.size()));
  for (size_t i = 0; i < x.size(); ++i) {
    const size_t next = (i + 1) % x.size();
    if (x[i] == x[next] && y[i] == y[next])
      t.at("x").fail(fmt::format("points {} and {} of the profile coincide", i + 1, next + 1));
  }
  return extrude(std::move(x), std::move(y), t.number("thickness", quantity::length, Range::positive()));
}

ShapePtr read_dog_bone(const ConfigTable& t) {
  const auto length = [&](const char* key) { return t.number(key, quantity::length, Range::positive()); };
  DogBone bone;
  bone.length = length("length");
  bone.width = length("width");
  bone.thickness = length("thickness");
  bone.narrow_length = length("narrow_length");
  bone.narrow_width = length("narrow_width");
  bone.fillet_radius = length("fillet_radius");
  if (bone.narrow_width >= bone.width) t.at("narrow_width").fail("'narrow_width' must be less than 'width'");
  if (2 * bone.fillet_radius < bone.width - bone.narrow_width)
    t.at("fillet_radius").fail("'fillet_radius' must be at least half of 'width' less 'narrow_width'");
  if (bone.narrow_length + 2 * bone.fillet_length() > bone.length)
    t.at("narrow_length")
        .fail(fmt::format("narrow section and fillets take {:.4g} of a 'length' of {:.4g} m",
                          bone.narrow_length + 2 * bone.fillet_length(), bone.length));
  return dog_bone(bone);
}

ShapePtr read_difference(const ConfigTable& t) {
  ShapePtr from = read_shape(t.at("from").table());
  return subtract(std::move(from), read_parts(t, "minus", 1));
}

ShapePtr read_placement(const ConfigTable& t, ShapePtr shape) {
  if (!t.has("scale") && !t.has("rotate") && !t.has("translate")) return shape;
  const double scale = t.number_or("scale", quantity::number, 1, Range::positive());
  Mat3 rotation = Mat3::Identity();
  if (const auto rotate = t.table_at("rotate")) {
    const Vec3 axis = direction(rotate->at("axis")).normalized();
    rotation = Eigen::AngleAxisd(rotate->number("angle", quantity::angle), axis).toRotationMatrix();
  }
  return transform(std::move(shape), scale, rotation,
                   t.vector_or("translate", quantity::length, Vec3::Zero()));
}

}  // namespace

ShapePtr read_shape(const ConfigTable& table) {
  table.record_as("shape");
  using Reader = std::function<ShapePtr(const ConfigTable&)>;
  const std::vector<std::pair<std::string, Reader>> readers = {
      {"sphere", read_sphere},
      {"box", read_box},
      {"cylinder", read_cylinder},
      {"capsule", read_capsule},
      {"half_space", read_half_space},
      {"extrude", read_extrude},
      {"astm_d638", read_dog_bone},
      {"union", [](const ConfigTable& t) { return unite(read_parts(t, "of", 1)); }},
      {"intersection", [](const ConfigTable& t) { return intersect(read_parts(t, "of", 1)); }},
      {"difference", read_difference},
  };
  std::vector<std::string> names;
  for (const auto& [name, reader] : readers) names.push_back(name);
  const size_t kind = table.at("shape").choice("shape", names);
  ShapePtr shape = readers[kind].second(table);
  shape = read_placement(table, std::move(shape));
  table.done();
  return shape;
}

}  // namespace cuboct
