// SPDX-License-Identifier: MIT
#include "model/body/mesh.h"

#include <fmt/format.h>

#include <filesystem>

#include "model/base/error.h"
#include "model/base/guarded_reader.h"
#include "model/base/module.h"
#include "model/base/process.h"

namespace cuboct {
namespace {

ReadMesh* find_reader() {
  void* const reader = module_symbol(kMeshModule, kReadMesh);
  if (reader != nullptr && !part_path(kMeshReader).empty()) return reinterpret_cast<ReadMesh*>(reader);
  throw InputError("this cuboct reads no meshes: it was built without Embree and Assimp",
                   "install libembree-dev and libassimp-dev, and build again");
}

}  // namespace

std::string mesh_text(const MeshFacts& facts) {
  std::string text =
      fmt::format("{} triangles, {}", facts.triangles, facts.closed() ? "closed" : "not closed");
  const auto add = [&](size_t count, const char* one, const char* more) {
    if (count > 0) text += fmt::format(", {} {}", count, count == 1 ? one : more);
  };
  add(facts.open, "open edge", "open edges");
  add(facts.crowded, "edge of more than two triangles", "edges of more than two triangles");
  add(facts.one_sided, "edge of triangles that cannot be turned one way",
      "edges of triangles that cannot be turned one way");
  add(facts.turned, "edge of triangles that were turned against each other",
      "edges of triangles that were turned against each other");
  add(facts.inside_out, "body that was inside out", "bodies that were inside out");
  text += fmt::format("; area {:.4g} m^2, volume {:.4g} m^3", facts.area, facts.volume);
  if (facts.overlap > 0)
    text += fmt::format(", of which bodies overlap in some {:.2g} %, which counts once", 100 * facts.overlap);
  text += fmt::format("; unit {:.7g} m", facts.unit);
  if (facts.stated_unit > 0)
    text += facts.stated_unit == facts.unit
                ? ", as the file states"
                : fmt::format(", where the file states {:.7g} m", facts.stated_unit);
  return text +
         (facts.up == 0 ? "" : fmt::format("; {} is up in the file, and stays {}", facts.up, facts.up));
}

std::string mesh_warning(const MeshFacts& facts) {
  constexpr double kGrazes = 1e-3;  // rays of a few points in 4096 meet an edge
  if (facts.doubt < kGrazes) return {};
  std::string what;
  const auto add = [&](size_t count, const char* of) {
    if (count > 0) what += fmt::format("{}{} {}", what.empty() ? "" : ", ", count, of);
  };
  add(facts.open, "open edges");
  add(facts.crowded, "edges of more than two triangles");
  add(facts.one_sided, "edges of triangles that cannot be turned one way");
  return fmt::format(
      "mesh {}: {}{}for {:.2g} % of the points inside some rays tell otherwise, and most rays decide",
      facts.file, what, what.empty() ? "" : "; ", 100 * facts.doubt);
}

Mesh read_mesh(const std::string& file, std::optional<double> unit) {
  static ReadMesh* const reader = find_reader();
  const Scratch scratch;
  const std::string triangles = scratch.path("triangles");
  read_guarded(part_path(kMeshReader), file, triangles, reader_limits(std::filesystem::file_size(file)));
  Mesh mesh;
  mesh.facts.file = file;
  std::string error;
  reader(triangles, unit, mesh, error);
  if (!error.empty()) throw InputError(error);
  const MeshFacts& facts = mesh.facts;
  if (facts.unit == 0)
    throw InputError("the file states no unit of length", "'unit' says it, for instance unit = \"mm\"");
  if (facts.too_coarse())
    throw InputError(
        fmt::format(
            "coordinates that far from the origin are read to {:.2g} m, too coarse for a body of {:.3g} m",
            facts.rounding, facts.size),
        "move it to the origin in the CAD program, and back by 'translate'");
  return mesh;
}

}  // namespace cuboct
