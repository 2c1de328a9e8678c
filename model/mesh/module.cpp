// SPDX-License-Identifier: MIT
// The module that reads meshes: Assimp reads the file, Embree searches the triangles.
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>

#include "model/mesh/solid.h"

namespace cuboct {
namespace {

// All meshes of the file, where its nodes put them; lines and points left out.
Surface triangles_of(const aiScene& scene, double unit) {
  Surface surface;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    const auto first = static_cast<uint32_t>(surface.points.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& x = mesh.mVertices[v];
      surface.points.push_back(unit * Vec3(x.x, x.y, x.z));
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      surface.triangles.push_back(
          {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }
  return surface;
}

bool is_finite(const Surface& surface) {
  for (const Vec3& x : surface.points)
    if (!x.allFinite()) return false;
  return true;
}

}  // namespace

extern "C" void cuboct_read_mesh(const std::string& file, double unit, Mesh& mesh, std::string& error) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    error = importer.GetErrorString();
    return;
  }
  Surface surface = triangles_of(*scene, unit);
  importer.FreeScene();
  if (!is_finite(surface)) {
    error = "a coordinate is not a finite number";
    return;
  }
  mesh.facts.flat = join_points(surface);
  if (surface.triangles.empty()) {
    error = "no triangle with an area";
    return;
  }
  look_at(surface, mesh.facts);
  mesh.shape = solid_within(std::move(surface), mesh.facts);
}

}  // namespace cuboct
