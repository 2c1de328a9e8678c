// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <utility>

#include "model/base/mat3.h"
#include "model/body/regions.h"

namespace cuboct {
namespace {

std::vector<ShapePtr> read_parts(const ConfigTable& table, const std::string& key, const Regions& regions) {
  std::vector<ShapePtr> parts;
  for (const ConfigValue& item : table.at(key).items()) parts.push_back(read_shape(item, regions));
  if (parts.empty()) table.at(key).fail(fmt::format("'{}' needs at least one shape", key));
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
                  axis ? axis->direction() : Vec3(Vec3::UnitZ()),
                  t.number("radius", quantity::length, Range::positive()),
                  t.number("length", quantity::length, Range::positive()));
}

ShapePtr read_capsule(const ConfigTable& t) {
  return capsule(t.at("from").vector(quantity::length), t.at("to").vector(quantity::length),
                 t.number("radius", quantity::length, Range::positive()));
}

ShapePtr read_half_space(const ConfigTable& t) {
  return half_space(t.vector_or("point", quantity::length, Vec3::Zero()), t.at("normal").direction());
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

ShapePtr read_mesh(const ConfigTable& t, const Regions& regions) {
  const ConfigValue file = t.at("file");
  if (const auto unit = t.find("unit")) return regions.mesh(file, unit->unit(quantity::length));
  return regions.mesh(file, file.reduced() ? std::optional<double>(1) : std::nullopt);
}

ShapePtr read_difference(const ConfigTable& t, const Regions& regions) {
  ShapePtr from = read_shape(t.at("from"), regions);
  return subtract(std::move(from), read_parts(t, "minus", regions));
}

ShapePtr read_placement(const ConfigTable& t, ShapePtr shape) {
  if (!t.has("scale") && !t.has("rotate") && !t.has("translate")) return shape;
  const double scale = t.number_or("scale", quantity::number, 1, Range::positive());
  Mat3 rotation = Mat3::Identity();
  if (const auto rotate = t.table_at("rotate")) {
    const Vec3 axis = rotate->at("axis").direction().normalized();
    rotation = Eigen::AngleAxisd(rotate->number("angle", quantity::angle), eigen(axis)).toRotationMatrix();
  }
  return transform(std::move(shape), scale, rotation,
                   t.vector_or("translate", quantity::length, Vec3::Zero()));
}

ShapePtr read_kind(const ConfigTable& table, const Regions& regions) {
  using Reader = std::function<ShapePtr(const ConfigTable&)>;
  const std::vector<std::pair<std::string, Reader>> readers = {
      {"sphere", read_sphere},
      {"box", read_box},
      {"cylinder", read_cylinder},
      {"capsule", read_capsule},
      {"half_space", read_half_space},
      {"extrude", read_extrude},
      {"astm_d638", read_dog_bone},
      {"mesh", [&](const ConfigTable& t) { return read_mesh(t, regions); }},
      {"union", [&](const ConfigTable& t) { return unite(read_parts(t, "of", regions)); }},
      {"intersection", [&](const ConfigTable& t) { return intersect(read_parts(t, "of", regions)); }},
      {"difference", [&](const ConfigTable& t) { return read_difference(t, regions); }},
  };
  std::vector<std::string> names;
  for (const auto& [name, reader] : readers) names.push_back(name);
  const ConfigValue kind = table.at("shape");
  const std::string name = kind.string();
  if (regions.has(name) && std::ranges::find(names, name) == names.end())
    kind.fail(fmt::format("unknown shape '{}'", name), fmt::format("of the region: region = \"{}\"", name));
  return readers[kind.choice("shape", names)].second(table);
}

}  // namespace

ShapePtr read_shape(const ConfigValue& value, const Regions& regions) {
  if (value.is_string()) return regions.named(value);
  if (!value.is_table())
    value.fail(fmt::format("'{}' must be the name of a region, or a shape", value.key()));
  const ConfigTable table = value.table();
  table.record_as("shape");
  table.not_both("shape", "region");
  const auto region = table.find("region");
  ShapePtr shape = read_placement(table, region ? regions.named(*region) : read_kind(table, regions));
  table.done();
  return shape;
}

}  // namespace cuboct
