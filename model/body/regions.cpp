// SPDX-License-Identifier: MIT
#include "model/body/regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/base/parallel.h"

namespace cuboct {
namespace {

constexpr size_t kDeepest = 64;            // regions of regions: each is a call within a call
constexpr size_t kMostShapes = 1'000'000;  // of one region: names can double it at each level

}  // namespace

Regions::Regions(const ConfigTable& root) {
  const auto table = root.table_at("regions");
  if (!table) return;
  for (const std::string& name : table->names()) {
    names_.push_back(name);
    values_.push_back(table->at(name));
  }
  shapes_.resize(names_.size());
  for (size_t k = 0; k < names_.size(); ++k) resolve(k, values_[k]);
}

bool Regions::has(const std::string& name) const { return std::ranges::find(names_, name) != names_.end(); }

ShapePtr Regions::named(const ConfigValue& name) const {
  if (names_.empty()) name.fail(fmt::format("unknown region '{}'", name.string()), "[regions] names shapes");
  return resolve(name.choice("region", names_), name);
}

ShapePtr Regions::resolve(size_t region, const ConfigValue& at) const {
  if (shapes_[region]) return shapes_[region];
  const auto same = std::ranges::find(open_, region);
  if (same != open_.end()) {
    std::string ring;
    for (auto k = same; k != open_.end(); ++k) ring += names_[*k] + ", ";
    at.fail(fmt::format("region '{}' is made of itself: {}{}", names_[region], ring, names_[region]));
  }
  if (open_.size() == kDeepest) at.fail(fmt::format("more than {} regions within one another", kDeepest));
  open_.push_back(region);
  ShapePtr shape = read_shape(values_[region], *this);
  open_.pop_back();
  if (shape->parts() > kMostShapes)
    values_[region].fail(fmt::format("region '{}' has {} parts: at most {} may be", names_[region],
                                     shape->parts(), kMostShapes));
  return shapes_[region] = std::move(shape);
}

ShapePtr Regions::mesh(const ConfigValue& file, std::optional<double> unit) const {
  const std::string path = file.file();
  for (const auto& [of, mesh] : meshes_)
    if (of == unit && mesh.facts.file == path) return mesh.shape;
  Mesh mesh;
  try {
    mesh = read_mesh(path, unit);
  } catch (const InputError& error) {
    const ErrorParts parts = parts_of(error);
    file.fail(fmt::format("'{}': {}", file.string(), parts.message), parts.hint);
  }
  const MeshFacts& facts = mesh.facts;
  // Reduced lengths are as many metres as the user thinks of.
  if (!file.reduced() && facts.stated_unit > 0 && std::abs(facts.unit / facts.stated_unit - 1) > 1e-6)
    file.fail(fmt::format("'{}' states that its unit is {:.7g} m{}, and 'unit' says {:.7g} m", file.string(),
                          facts.stated_unit, facts.up == 0 ? "" : fmt::format(" and that {} is up", facts.up),
                          facts.unit),
              "leave 'unit' out; 'scale' makes a shape larger or smaller, and 'rotate' turns it");
  constexpr double kMostDoubt = 0.25;
  if (facts.doubt > kMostDoubt)
    file.fail(fmt::format(
                  "'{}' holds no solid: its surface has {} open edges, and for {:.0f} % of the points inside "
                  "some rays tell otherwise",
                  file.string(), facts.open, 100 * facts.doubt),
              "a closed mesh: CAD programs and MeshLab close holes");
  meshes_.emplace_back(unit, mesh);
  return mesh.shape;
}

std::vector<MeshFacts> Regions::mesh_facts() const {
  std::vector<MeshFacts> facts;
  for (const auto& [unit, mesh] : meshes_) facts.push_back(mesh.facts);
  return facts;
}

std::vector<uint32_t> Regions::select(const ConfigValue& value, const std::vector<Vec3>& x,
                                      double tolerance) const {
  const ShapePtr shape = read_shape(value, *this);
  constexpr double kMostTests = 4e10;  // of one scene: some minutes
  tests_ += static_cast<double>(x.size()) * static_cast<double>(shape->parts());
  if (tests_ > kMostTests)
    value.fail(
        fmt::format("{:.3g} tests of particles against regions: at most {:.3g} are made", tests_, kMostTests),
        "fewer regions, or shapes of fewer points");
  std::vector<char> in(x.size());
  for_each_range(x.size(), 10'000, [&](size_t begin, size_t end) {
    for (size_t id = begin; id < end; ++id) in[id] = shape->distance(x[id]) <= tolerance;
  });
  std::vector<uint32_t> ids;
  for (uint32_t id = 0; id < x.size(); ++id)
    if (in[id] != 0) ids.push_back(id);
  if (ids.empty()) value.fail("no particle lies in this region");
  return ids;
}

}  // namespace cuboct
