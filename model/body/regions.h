// SPDX-License-Identifier: MIT
// [regions]: shapes with names, which may be made of one another. Wherever a shape is asked for, the name of
// a region may stand.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/body/geometry.h"
#include "model/body/mesh.h"
#include "model/config/config.h"

namespace cuboct {

class Regions {
 public:
  // Reads all of [regions]; one that is made of itself is an error.
  explicit Regions(const ConfigTable& root);
  bool has(const std::string& name) const;
  // Of all meshes read so far, in the order of their first use; each file is read once.
  ShapePtr mesh(const ConfigValue& file, std::optional<double> unit) const;
  std::vector<MeshFacts> mesh_facts() const;
  // The shape of the region that a string of the file names.
  ShapePtr named(const ConfigValue& name) const;
  // The particles whose initial position lies in the region (surface included); none is an error.
  std::vector<uint32_t> select(const ConfigValue& value, const std::vector<Vec3>& x, double tolerance) const;
  // The k-th region of the file, in the order of names().
  const std::vector<std::string>& names() const { return names_; }
  ShapePtr shape(size_t k) const { return resolve(k, values_[k]); }
  std::vector<uint32_t> select(size_t k, const std::vector<Vec3>& x, double tolerance) const {
    return select(values_[k], x, tolerance);
  }

 private:
  ShapePtr resolve(size_t region, const ConfigValue& at) const;

  std::vector<std::string> names_;
  std::vector<ConfigValue> values_;
  mutable std::vector<ShapePtr> shapes_;  // null until resolved
  mutable std::vector<size_t> open_;      // being resolved, each made of the next
  mutable std::vector<std::pair<std::optional<double>, Mesh>> meshes_;  // with the unit that was given, m
  mutable double tests_ = 0;                                            // of particles, by select()
};

// "name", { shape = "...", ... } or { region = "name", ... }; docs/user/scene.md lists shapes and keys.
// Throws InputError.
ShapePtr read_shape(const ConfigValue& value, const Regions& regions);

}  // namespace cuboct
