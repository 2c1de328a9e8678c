// SPDX-License-Identifier: MIT
#include "cli/run/packing_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "model/base/quantity_text.h"
#include "model/contract/material_name.h"
#include "model/scene/packed_shape.h"

namespace cuboct {
namespace {

constexpr size_t kMostMaterials = 6;
constexpr double kWorthAPitch = 0.05;  // of the section: a change that `cuboct pitch` is named for

std::string length_text(const Scene& scene, double length) {
  return quantity_text(length, scene.boltzmann == 1 ? "" : "m");
}

// "1.2 mm^2"; the prefix of a unit of area is squared with it.
std::string area_text(const Scene& scene, double area) {
  if (scene.boltzmann == 1) return fmt::format("{:.3g}", area);
  const Multiple side = multiple_of(std::sqrt(area), "m");
  return fmt::format("{:.3g} {}^2", area / (side.unit * side.unit), side.name);
}

std::string vector_text(const Scene& scene, const Vec3& x) {
  const Multiple unit = scene.boltzmann == 1 ? Multiple{1, ""} : multiple_of(x.cwiseAbs().maxCoeff(), "m");
  const auto number = [&](double value) {
    return std::abs(value) < 1e-9 * scene.pitch ? 0.0 : value / unit.unit;
  };
  return fmt::format("[{:.3g}, {:.3g}, {:.3g}]{}{}", number(x[0]), number(x[1]), number(x[2]),
                     unit.name.empty() ? "" : " ", unit.name);
}

struct Layers {
  int axis;
  double spacing;  // m
  int64_t count;
};

// Those that hold particles: between two bodies there may be some without, and one layer of the packing
// across another axis has not all of them.
Layers layers_in(const std::vector<Vec3>& x, int axis, double spacing) {
  std::vector<int64_t> places;
  places.reserve(x.size());
  for (const Vec3& at : x) places.push_back(std::llround((at[axis] - x.front()[axis]) / spacing));
  std::ranges::sort(places);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  int64_t apart = places.size() < 2 ? 1 : places.back() - places.front();
  for (size_t k = 1; k < places.size(); ++k) apart = std::min(apart, places[k] - places[k - 1]);
  return {axis, static_cast<double>(apart) * spacing, static_cast<int64_t>(places.size())};
}

std::vector<Layers> layers_of(const Scene& scene, const PackedShape& packed) {
  std::vector<Layers> layers;
  for (int a = 0; a < 3; ++a)
    if (const auto& along = packed.along[static_cast<size_t>(a)])
      layers.push_back(layers_in(scene.packing().x, a, layer_spacing(packed.fcc, *along)));
  return layers;
}

// "20 x 10 x 4 along x, y and z, 50 um, 71 um and 50 um apart".
std::string layers_text(const Scene& scene, const std::vector<Layers>& layers) {
  std::vector<std::string> counts, axes, spacings;
  for (const Layers& of : layers) {
    counts.push_back(std::to_string(of.count));
    axes.emplace_back(1, "xyz"[of.axis]);
    spacings.push_back(length_text(scene, of.spacing));
  }
  const auto listed = [](const std::vector<std::string>& words) {
    std::string text = words.front();
    for (size_t k = 1; k < words.size(); ++k) text += (k + 1 == words.size() ? " and " : ", ") + words[k];
    return text;
  };
  const bool alike = std::ranges::adjacent_find(spacings, std::not_equal_to{}) == spacings.end();
  return fmt::format("{} along {}, {} apart", fmt::join(counts, " x "), listed(axes),
                     alike ? spacings.front() : listed(spacings));
}

std::string section_text(const Scene& scene, const PackedSection& section) {
  return fmt::format(
      "{} across {} at {}, {:.0f} % of the shape's; another place of the packing makes {:.0f} to {:.0f} %, "
      "and "
      "{:.0f} to {:.0f} % of its bending stiffness",
      area_text(scene, section.mean * section.area.packed), "xyz"[section.axis],
      length_text(scene, section.at), 100 * section.area.packed, 100 * section.area.least,
      100 * section.area.most, 100 * section.bending.least, 100 * section.bending.most);
}

void add_materials(Items& items, const Scene& scene) {
  struct Part {
    std::string name;
    Vec3 low, high;
    size_t count = 0;
  };
  std::vector<Part> parts;
  std::vector<size_t> part_of;
  for (const ParticleType& type : scene.rule.types) {
    const std::string name = material_of(type.name);
    const auto known = std::ranges::find(parts, name, &Part::name);
    part_of.push_back(static_cast<size_t>(known - parts.begin()));
    if (known == parts.end()) parts.push_back({name, {}, {}});
  }
  if (parts.size() < 2 || parts.size() > kMostMaterials) return;
  for (size_t id = 0; id < scene.body.size(); ++id) {
    Part& part = parts[part_of[scene.body.type[id]]];
    const Vec3& x = scene.body.x[id];
    part.low = part.count == 0 ? x : part.low.cwiseMin(x);
    part.high = part.count == 0 ? x : part.high.cwiseMax(x);
    ++part.count;
  }
  for (const Part& part : parts) {
    if (part.count == 0) continue;
    items.add("material " + part.name,
              fmt::format("from {} to {}, {}", vector_text(scene, part.low), vector_text(scene, part.high),
                          counted(part.count, "particle")));
  }
}

}  // namespace

void add_packing(Items& items, const Scene& scene) {
  add_materials(items, scene);
  const auto packed = packed_shape(scene);
  if (!packed) return;
  if (const auto layers = layers_of(scene, *packed); !layers.empty())
    items.add("layers", layers_text(scene, layers));
  if (const auto section = packed_section(*packed))
    items.add("section", section_text(scene, *section),
              section->area.range() > kWorthAPitch ? "'cuboct pitch' finds the pitch for an error" : "");
}

void add_packing_numbers(Items& items, const Scene& scene) {
  const auto packed = packed_shape(scene);
  if (!packed) return;
  for (const Layers& of : layers_of(scene, *packed)) {
    items.add(fmt::format("layers {}", "xyz"[of.axis]), of.count);
    items.add(fmt::format("layer spacing {}", "xyz"[of.axis]), of.spacing, "m");
  }
  const auto section = packed_section(*packed);
  if (!section) return;
  items.add(
      "section", section->mean * section->area.packed, "m^2",
      fmt::format("across {} at {:.4g} m, by the particles near it", "xyz"[section->axis], section -> at));
  // Of the shape's; smallest and largest with the packing elsewhere.
  const auto add = [&](const std::string& name, const PackedSection::Share& share) {
    items.add_range(name, share.packed, share.least, share.most, "1");
  };
  add("section area share", section->area);
  add("section bending share", section->bending);
}

}  // namespace cuboct
