// SPDX-License-Identifier: MIT
// cuboct-read-mesh FILE RESULT SECONDS MEGABYTES: the program that reads meshes by Assimp, which some files
// crash. model/base/guarded_reader.h runs it; RESULT is model/mesh/triangle_file.h's.
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <unistd.h>

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <fmt/format.h>
#include <minizip/unzip.h>

#include <Eigen/Dense>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/base/guarded_reader.h"
#include "model/base/standard_streams.h"
#include "model/mesh/stated_unit.h"
#include "model/mesh/triangle_file.h"

namespace cuboct {
namespace {

// Those whose unit and axes are known: by the format, by what the file states, or that it states none.
constexpr const char* kFormats[] = {"stl", "obj", "ply", "off", "dae", "3mf", "amf"};

// Formats may name other files, of which a stranger's has none to read.
class OneFile final : public Assimp::DefaultIOSystem {
 public:
  explicit OneFile(std::string file) : file_(std::move(file)) {}
  bool Exists(const char* file) const override { return file == file_; }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return file == file_ ? DefaultIOSystem::Open(file, mode) : nullptr;
  }

 private:
  std::string file_;
};

std::string format_of(const std::string& file) {
  std::string end = file.substr(file.find_last_of("./") + 1);
  for (char& c : end) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* format : kFormats)
    if (end == format) return end;
  throw std::runtime_error(
      "its name ends in no format that is read: .stl, .obj, .ply, .off, .dae, .3mf or .amf");
}

// The one of this format: others would look into the file and may take it for theirs.
void keep_only(Assimp::Importer& importer, const std::string& format) {
  const Assimp::BaseImporter* const kept = importer.GetImporter(format.c_str());
  for (size_t k = importer.GetImporterCount(); k-- > 0;)
    if (Assimp::BaseImporter* other = importer.GetImporter(k); other != kept)
      importer.UnregisterLoader(other);
}

double stated_metres(const std::string& xml, const std::string& element) {
  const std::string unit = attribute(xml, element, "unit", "millimeter");  // both standards' default
  if (const double metres = metres_of(unit); metres != 0) return metres;
  throw std::runtime_error("it states an unknown unit, " + unit);
}

// A 3MF is a zip archive, whose models are the files that end so.
std::vector<std::string> models_in(const std::string& file) {
  std::vector<std::string> models;
  const std::unique_ptr<void, int (*)(unzFile)> archive(unzOpen64(file.c_str()), unzClose);
  if (!archive) throw std::runtime_error("it is no 3MF: not a zip archive");
  for (int more = unzGoToFirstFile(archive.get()); more == UNZ_OK; more = unzGoToNextFile(archive.get())) {
    unz_file_info64 info{};
    std::string name(1024, '\0');
    unzGetCurrentFileInfo64(archive.get(), &info, name.data(), name.size(), nullptr, 0, nullptr, 0);
    name.resize(std::min<size_t>(info.size_filename, name.size()));
    if (!name.ends_with(".model")) continue;
    std::string head(1 << 16, ' ');  // the first element is near the begin
    unzOpenCurrentFile(archive.get());
    const int bytes = unzReadCurrentFile(archive.get(), head.data(), static_cast<unsigned>(head.size()));
    head.resize(static_cast<size_t>(std::max(bytes, 0)));
    models.push_back(std::move(head));
  }
  return models;
}

// Assimp reads neither 3MF's nor AMF's unit.
double unit_of_archive(const std::string& file) {
  double unit = 0;
  for (const std::string& model : models_in(file)) {
    const double metres = stated_metres(model, "model");
    if (unit != 0 && metres != unit) throw std::runtime_error("its models state different units");
    unit = metres;
  }
  return unit;
}

double unit_of_text(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text(1 << 16, ' ');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<size_t>(in.gcount()));
  return stated_metres(text, "amf");
}

// Assimp turns COLLADA's scene to metres and y up by its root, which is otherwise the identity. Its row of y
// is then that of the axis that is up. Seven digits are what its float holds of 0.001.
void take_back(aiNode& root, TriangleFileHead& head) {
  const aiMatrix4x4& m = root.mTransformation;
  const double unit = std::sqrt(double{m.a1} * m.a1 + double{m.b1} * m.b1 + double{m.c1} * m.c1);
  head.unit = std::stod(fmt::format("{:.7g}", unit));
  head.up = m.b1 > 0.5 * unit ? 'x' : m.b3 > 0.5 * unit ? 'z' : 'y';
  root.mTransformation = aiMatrix4x4();
}

struct Triangles {
  std::vector<double> points;
  std::vector<uint32_t> corners;
  double largest = 0;  // size of what a coordinate is a sum of
};

using Placement = Eigen::Matrix4d;

// Lines and points are left out.
void add(const aiMesh& mesh, const Placement& at, Triangles& to) {
  const auto first = static_cast<uint32_t>(to.points.size() / 3);
  const Eigen::Matrix3d turn = at.topLeftCorner<3, 3>();
  const Eigen::Vector3d shift = at.topRightCorner<3, 1>();
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const Eigen::Vector3d in(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
    const Eigen::Vector3d x = turn * in + shift;
    if (!x.allFinite()) throw std::runtime_error("a coordinate is not a finite number");
    to.points.insert(to.points.end(), x.begin(), x.end());
    to.largest = std::max(to.largest, (turn.cwiseAbs() * in.cwiseAbs() + shift.cwiseAbs()).maxCoeff());
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;
    for (int k = 0; k < 3; ++k) to.corners.push_back(first + face.mIndices[k]);
  }
}

void add(const aiScene& scene, const aiNode& node, const Placement& above, Triangles& to) {
  const aiMatrix4x4& m = node.mTransformation;
  Placement own;
  own << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  const Placement at = above * own;
  for (unsigned k = 0; k < node.mNumMeshes; ++k) add(*scene.mMeshes[node.mMeshes[k]], at, to);
  for (unsigned k = 0; k < node.mNumChildren; ++k) add(scene, *node.mChildren[k], at, to);
}

void write(const std::string& path, TriangleFileHead head, const Triangles& triangles) {
  head.points = triangles.points.size() / 3, head.triangles = triangles.corners.size() / 3;
  head.rounding = std::ldexp(triangles.largest, -24);
  std::ofstream out(path, std::ios::binary);
  const auto put = [&](const void* from, size_t bytes) {
    out.write(static_cast<const char*>(from), static_cast<std::streamsize>(bytes));
  };
  put(&head, sizeof head);
  put(triangles.points.data(), triangles.points.size() * sizeof(double));
  put(triangles.corners.data(), triangles.corners.size() * sizeof(uint32_t));
  if (!out.flush()) throw std::runtime_error("no room for its triangles in " + path);
}

void read(const std::string& file, const std::string& result) {
  const std::string format = format_of(file);
  TriangleFileHead head;
  if (format == "3mf") head.unit = unit_of_archive(file), head.up = 'z';  // its standard says z
  if (format == "amf") head.unit = unit_of_text(file);
  Assimp::Importer importer;
  keep_only(importer, format);
  importer.SetIOHandler(new OneFile(file));  // the importer's from now on
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  if (importer.ReadFile(file, aiProcess_Triangulate) == nullptr) {
    // Assimp catches what its own memory throws.
    const std::string why = importer.GetErrorString();
    if (why.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    throw std::runtime_error(why);
  }
  aiScene* const scene = importer.GetOrphanedScene();
  if (format == "dae") take_back(*scene->mRootNode, head);
  Triangles triangles;
  add(*scene, *scene->mRootNode, Placement::Identity(), triangles);
  write(result, head, triangles);
}

}  // namespace
}  // namespace cuboct

int main(int count, char** words) try {
  cuboct::fill_standard_descriptors();
  if (count != 5) throw std::runtime_error("usage: cuboct-read-mesh FILE RESULT SECONDS MEGABYTES");
  cuboct::take_limits({std::stoull(words[3]), std::stoull(words[4])});
  cuboct::read(words[1], words[2]);
  _exit(0);  // what Assimp still holds it need not free
} catch (const std::bad_alloc&) {
  std::fprintf(stderr, "reading it takes more than %s MB of memory\n", words[4]);
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
