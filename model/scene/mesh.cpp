// SPDX-License-Identifier: MIT
#include "model/scene/mesh.h"

#include <fmt/format.h>

#include "model/base/error.h"
#include "model/base/module.h"

namespace cuboct {
namespace {

ReadMesh* find_reader() {
  if (void* reader = module_symbol(kMeshModule, kReadMesh)) return reinterpret_cast<ReadMesh*>(reader);
  throw InputError("this cuboct reads no meshes: it was built without Embree and Assimp",
                   "install libembree-dev and libassimp-dev, and build again");
}

}  // namespace

std::string mesh_warning(const MeshFacts& facts) {
  if (facts.closed() && facts.turned == 0) return {};
  std::string what;
  const auto add = [&](size_t count, const char* of) {
    if (count > 0) what += fmt::format("{}{} {}", what.empty() ? "" : ", ", count, of);
  };
  add(facts.open, "open edges");
  add(facts.crowded, "edges of more than two triangles");
  add(facts.turned, "edges between triangles that are turned against each other");
  return fmt::format(
      "mesh {}: {}; for {:.2g} % of the points inside some rays tell otherwise, and most rays decide",
      facts.file, what, 100 * facts.doubt);
}

Mesh read_mesh(const std::string& file, double unit) {
  static ReadMesh* const reader = find_reader();
  Mesh mesh;
  std::string error;
  reader(file, unit, mesh, error);
  if (!error.empty()) throw InputError(error);
  return mesh;
}

}  // namespace cuboct
