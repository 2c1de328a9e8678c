// SPDX-License-Identifier: MIT
// Solids from meshes, against the same solids as closed forms.
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <random>

#include "model/body/packing.h"
#include "tests/unit/mesh_files.h"

namespace cuboct {
namespace {

// The sphere of radius 5: an octahedron whose triangles are cut in four `times` over.
Triangles ball(int times) {
  Triangles t;
  for (int k = 0; k < 6; ++k) t.x.emplace_back(5 * (k % 2 ? -1 : 1) * Vec3::Unit(k / 2));
  for (uint32_t k = 0; k < 8; ++k) {
    const uint32_t a = k & 1, b = 2 + (k >> 1 & 1), c = 4 + (k >> 2);
    t.corners.push_back((std::popcount(k) & 1) == 0 ? std::array{a, b, c} : std::array{a, c, b});
  }
  for (int k = 0; k < times; ++k) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [found, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(t.x.size()));
      if (fresh) t.x.push_back(5 * (t.x[a] + t.x[b]).normalized());
      return found->second;
    };
    std::vector<std::array<uint32_t, 3>> finer;
    for (const auto& [a, b, c] : t.corners) {
      const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& corner : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(corner);
    }
    t.corners = finer;
  }
  return t;
}

using Meshes = MeshFiles;

#ifdef CUBOCT_MESH_DIRECTORY

// Every format gives the box's own sites, those on its faces too, which are planes of the crystal.
TEST_F(Meshes, OfACubeGiveTheSitesOfTheBox) {
  const Fcc fcc{.pitch = std::sqrt(2.0) / 2};  // cells of edge 1: sites on every face
  const auto exact = pack(fcc, box(Vec3::Constant(-5), Vec3::Constant(5)).get(), {});
  ASSERT_EQ(exact.size(), 11 * 11 * 11 + 3 * 11 * 10 * 10U);
  for (const std::string& file : {write_obj("a.obj", cube()), write_ply("a.ply", cube()),
                                  write_stl("a.stl", cube()), write_binary_stl("b.stl", cube())}) {
    const Mesh mesh = read_mesh(file, 1);
    EXPECT_EQ(mesh.facts.triangles, 12U);
    EXPECT_TRUE(mesh.facts.closed());
    EXPECT_EQ(mesh.facts.turned, 0U);
    EXPECT_NEAR(mesh.facts.area, 600, 1e-9);
    EXPECT_NEAR(mesh.facts.volume, 1000, 1e-9);
    EXPECT_LT(mesh.facts.doubt, 1e-3);
    EXPECT_EQ(pack(fcc, mesh.shape.get(), {}), exact) << file;
  }
}

// Distance and sign, against the box's own; 2^-22 of the largest coordinate counts as on the surface.
TEST_F(Meshes, TellDistances) {
  const Mesh mesh = read_mesh(write_obj("a.obj", cube()), 1e-3);
  const ShapePtr exact = box(Vec3::Constant(-5e-3), Vec3::Constant(5e-3));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> within(-8e-3, 8e-3);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 x(within(random), within(random), within(random));
    EXPECT_NEAR(mesh.shape->distance(x), exact->distance(x) - std::ldexp(5e-3, -22), 1e-12);
  }
}

// Corners on the sphere: what facets cut off goes down fourfold with each halving of their edges.
TEST_F(Meshes, OfABallHaveItsVolumeAndArea) {
  const double volume = 4 * M_PI / 3 * 125, area = 4 * M_PI * 25;
  const MeshFacts coarse = read_mesh(write_binary_stl("a.stl", ball(4)), 1).facts;
  const Mesh mesh = read_mesh(write_binary_stl("b.stl", ball(5)), 1);
  EXPECT_EQ(mesh.facts.triangles, 8192U);
  EXPECT_TRUE(mesh.facts.closed());
  EXPECT_GT(volume - mesh.facts.volume, 0);
  EXPECT_NEAR((volume - coarse.volume) / (volume - mesh.facts.volume), 4, 0.1);
  EXPECT_NEAR((area - coarse.area) / (area - mesh.facts.area), 4, 0.1);
  const ShapePtr sphere_of = sphere(Vec3::Zero(), 5);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> within(-7, 7);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 x(within(random), within(random), within(random));
    EXPECT_NEAR(mesh.shape->distance(x), sphere_of->distance(x), 0.02);
  }
}

// One triangle of a hundred is missing: the sites are those of the whole but for few within a hole's width of
// the surface, and a warning says so.
TEST_F(Meshes, MayLeak) {
  const Fcc fcc{.pitch = 0.4};
  Triangles t = ball(4);
  const auto whole = pack(fcc, read_mesh(write_stl("a.stl", t), 1).shape.get(), {});
  std::vector<std::array<uint32_t, 3>> kept;
  for (size_t k = 0; k < t.corners.size(); ++k)
    if (k % 100 != 50) kept.push_back(t.corners[k]);
  t.corners = kept;
  const Mesh leaky = read_mesh(write_stl("b.stl", t), 1);
  EXPECT_EQ(leaky.facts.open, 60U);
  EXPECT_NEAR(leaky.facts.doubt, 1 - std::pow(0.99, 11), 0.03);
  EXPECT_NE(mesh_warning(leaky.facts).find("60 open edges"), std::string::npos);
  const auto packed = pack(fcc, leaky.shape.get(), {});
  size_t others = 0;
  const auto look_for = [&](const std::vector<Vec3>& from, const std::vector<Vec3>& in) {
    for (const Vec3& x : from) {
      if (std::ranges::find(in, x) != in.end()) continue;
      EXPECT_NEAR(x.norm(), 5, 0.5);  // edges are up to 0.5 long
      ++others;
    }
  };
  look_for(packed, whole);
  look_for(whole, packed);
  EXPECT_LE(others, 20u);  // holes
}

TEST_F(Meshes, ThatAreTurnedOrFlatInPlacesAreTold) {
  Triangles t = cube();
  std::swap(t.corners[3][0], t.corners[3][1]);
  t.corners.push_back({0, 0, 1});
  const Mesh mesh = read_mesh(write_obj("a.obj", t), 1);
  EXPECT_EQ(mesh.facts.flat, 1U);
  EXPECT_EQ(mesh.facts.turned, 3U);
  EXPECT_NE(mesh_text(mesh.facts).find("closed, 3 edges of triangles that were turned"), std::string::npos)
      << mesh_text(mesh.facts);
  EXPECT_EQ(mesh_warning(mesh.facts), "");
  EXPECT_NEAR(mesh.shape->distance({0, 0, 4}), -1, 1e-5);
}

// A mesh may be a body, and a region that a constraint holds.
TEST_F(Meshes, MakeBodiesAndRegions) {
  write_stl("part.stl", cube());
  const std::string shape = R"(shape = "mesh"
file = "part.stl"
unit = "mm"
)";
  const Scene body = scene(shape);
  const Scene same = scene("shape = \"box\"\nsize = \"[10, 10, 10] mm\"");
  EXPECT_EQ(body.body.x, same.body.x);
  ASSERT_EQ(body.meshes.size(), 1U);
  EXPECT_NEAR(body.meshes[0].volume, 1e-6, 1e-15);
  const Scene held = scene("shape = \"box\"\nsize = \"[30, 10, 10] mm\"", R"(
[[constraint]]
name = "grip"
kind = "held"
region = { shape = "mesh", file = "part.stl", unit = "mm", translate = "[-12, 0, 0] mm" }
)");
  size_t count = 0, of_box = 0;
  for (size_t i = 0; i < held.body.size(); ++i) {
    count += held.rule.types[held.body.type[i]].imposed[0];
    of_box += held.body.x[i][0] <= -7e-3 + 1e-9;
  }
  EXPECT_EQ(count, of_box);
  EXPECT_GT(count, 0U);
}

TEST_F(Meshes, ThatHoldNoSolidAreRefused) {
  Triangles half = ball(4);
  half.corners.resize(half.corners.size() / 2);
  write_stl("half.stl", half);
  write("text.stl", "no mesh\n");
  write("empty.obj", "v 0 0 0\n");
  write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 2 4\nf 2 3 4\n");
  const auto of = [](const std::string& file, const std::string& unit) {
    return fmt::format("shape = \"mesh\"\nfile = \"{}\"\n{}", file, unit);
  };
  const std::string mm = "unit = \"mm\"";
  EXPECT_NE(error_of(of("half.stl", mm)).find("scene.toml:12:8: 'half.stl' holds no solid"),
            std::string::npos)
      << error_of(of("half.stl", mm));
  EXPECT_NE(error_of(of("none.stl", mm)).find("no file 'none.stl'"), std::string::npos);
  const std::string longer = std::string(300, 'x') + ".stl";  // than a file's name can be
  EXPECT_NE(error_of(of(longer, mm)).find("scene.toml:12:8: no file '" + longer + "'"), std::string::npos);
  EXPECT_NE(error_of(of("half.stl", "")).find("'unit'"), std::string::npos) << error_of(of("half.stl", ""));
  for (const char* file : {"text.stl", "empty.obj", "nan.obj"})
    EXPECT_NE(error_of(of(file, mm)).find("scene.toml:12:8: "), std::string::npos) << error_of(of(file, mm));
}

#else

TEST_F(Meshes, ThatThisBuildDoesNotReadAreRefused) {
  write_stl("part.stl", cube());
  EXPECT_NE(error_of("shape = \"mesh\"\nfile = \"part.stl\"\nunit = \"mm\"").find("reads no meshes"),
            std::string::npos);
}

#endif

}  // namespace
}  // namespace cuboct
