// SPDX-License-Identifier: MIT
// Meshes that tests write, and the scenes that hold them.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "model/base/error.h"
#include "model/base/process.h"
#include "model/body/mesh.h"
#include "model/scene/scene.h"

namespace cuboct {

struct Triangles {
  std::vector<Vec3> x;
  std::vector<std::array<uint32_t, 3>> corners;
};

// A box, normals outwards.
inline Triangles cuboid(const Vec3& low, const Vec3& high) {
  Triangles t;
  for (int k = 0; k < 8; ++k)
    t.x.emplace_back((k & 1 ? high : low)[0], (k & 2 ? high : low)[1], (k & 4 ? high : low)[2]);
  for (const auto& [a, b, c, d] : std::vector<std::array<uint32_t, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    t.corners.push_back({a, b, c});
    t.corners.push_back({a, c, d});
  }
  return t;
}

// The cube of edge 10 about the origin.
inline Triangles cube() { return cuboid(Vec3::Constant(-5), Vec3::Constant(5)); }

// Both, as two bodies of one mesh.
inline Triangles both(Triangles a, const Triangles& b) {
  const auto first = static_cast<uint32_t>(a.x.size());
  a.x.insert(a.x.end(), b.x.begin(), b.x.end());
  for (const auto& [p, q, r] : b.corners) a.corners.push_back({first + p, first + q, first + r});
  return a;
}

// The same with its normals the other way.
inline Triangles inside_out(Triangles t) {
  for (auto& corner : t.corners) std::swap(corner[1], corner[2]);
  return t;
}

class MeshFiles : public testing::Test {
 protected:
  MeshFiles() : directory_(std::filesystem::path(testing::TempDir()) / fmt::format("meshes.{}", getpid())) {
    std::filesystem::create_directories(directory_);
#ifdef CUBOCT_MESH_DIRECTORY
    set_program_directory(CUBOCT_MESH_DIRECTORY);
#else
    set_program_directory(directory_.string());
#endif
  }
  ~MeshFiles() override {
    set_program_directory("");
    std::filesystem::remove_all(directory_);
  }
  std::string path(const std::string& name) const { return (directory_ / name).string(); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  std::string write_obj(const std::string& name, const Triangles& t) const {
    std::string text;
    for (const Vec3& x : t.x) text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", x[0], x[1], x[2]);
    for (const auto& [a, b, c] : t.corners) text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
    return write(name, text);
  }
  std::string write_ply(const std::string& name, const Triangles& t) const {
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        t.x.size(), t.corners.size());
    for (const Vec3& x : t.x) text += fmt::format("{:.9g} {:.9g} {:.9g}\n", x[0], x[1], x[2]);
    for (const auto& [a, b, c] : t.corners) text += fmt::format("3 {} {} {}\n", a, b, c);
    return write(name, text);
  }
  std::string write_stl(const std::string& name, const Triangles& t) const {
    std::string text = "solid part\n";
    for (const auto& corner : t.corners) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const uint32_t k : corner)
        text += fmt::format("vertex {:.9g} {:.9g} {:.9g}\n", t.x[k][0], t.x[k][1], t.x[k][2]);
      text += "endloop\nendfacet\n";
    }
    return write(name, text + "endsolid part\n");
  }
  std::string write_binary_stl(const std::string& name, const Triangles& t) const {
    std::string bytes(80, ' ');
    const auto put = [&](const auto& value) {
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(static_cast<uint32_t>(t.corners.size()));
    for (const auto& corner : t.corners) {
      for (int k = 0; k < 3; ++k) put(0.0F);
      for (const uint32_t k : corner)
        for (int a = 0; a < 3; ++a) put(static_cast<float>(t.x[k][a]));
      put(uint16_t{0});
    }
    return write(name, bytes);
  }

  Scene scene(const std::string& geometry, const std::string& more = {}) const {
    return parse_scene(R"(density = "1 g/cm^3"
[packing]
pitch = "0.5 mm"
[law]
kind = "elastic"
youngs_modulus = "20 kPa"
direction = "z"
[run]
steps = 1
[geometry]
)" + geometry + "\n" + more,
                       path("scene.toml"));
  }
  std::string error_of(const std::string& geometry) const {
    try {
      scene(geometry);
    } catch (const InputError& error) {
      return error.told();
    }
    return "none";
  }

  std::filesystem::path directory_;
};

}  // namespace cuboct
