// SPDX-License-Identifier: MIT
// Meshes of several bodies, against the same solids as closed forms.
#ifdef CUBOCT_MESH_DIRECTORY

#include "model/body/packing.h"
#include "tests/unit/mesh_files.h"

namespace cuboct {
namespace {

using MeshBodies = MeshFiles;

// Sites on no face of the bodies below.
const Fcc kFcc{.pitch = 0.53, .offset = Vec3(0.117, 0.071, 0.039)};

std::vector<Vec3> sites_of(const Mesh& mesh) { return pack(kFcc, mesh.shape.get(), {}); }
std::vector<Vec3> sites_of(const ShapePtr& shape) { return pack(kFcc, shape.get(), {}); }

// A cube of edge 10 and a bar of 10 x 4 x 4 that reaches 5 into it: 80 of 1080 mm^3 are within both.
// Whichever way the normals of each body point, the solid is the union.
TEST_F(MeshBodies, ThatOverlapAreOne) {
  const Triangles bar = cuboid({0, -2, -2}, {10, 2, 2});
  const ShapePtr exact = unite({box(Vec3::Constant(-5), Vec3::Constant(5)), box({0, -2, -2}, {10, 2, 2})});
  const std::vector<Vec3> sites = sites_of(exact);
  const struct {
    Triangles mesh;
    size_t inside_out;
  } cases[] = {{both(cube(), bar), 0},
               {both(cube(), inside_out(bar)), 1},
               {both(inside_out(cube()), bar), 1},
               {inside_out(both(cube(), bar)), 0}};
  for (const auto& [triangles, inside_out] : cases) {
    const Mesh mesh = read_mesh(write_stl("a.stl", triangles), 1);
    EXPECT_TRUE(mesh.facts.closed());
    EXPECT_EQ(mesh.facts.inside_out, inside_out);
    EXPECT_NEAR(mesh.facts.volume, 1160, 1e-9);
    EXPECT_NEAR(mesh.facts.overlap, 80.0 / 1080,
                0.02);  // of some 3000 points drawn: four standard deviations
    EXPECT_EQ(mesh_warning(mesh.facts), "");
    EXPECT_EQ(sites_of(mesh), sites);
    EXPECT_LT(mesh.shape->distance({2.5, 0, 0}), -1);
    EXPECT_NEAR(mesh.shape->distance({12, 0, 0}), 2, 1e-5);
  }
}

// A body within another whose normals point inwards is a cavity, and one whose normals point outwards is
// part of the other.
TEST_F(MeshBodies, WithinOthersAreCavitiesByTheirNormals) {
  const Triangles core = cuboid(Vec3::Constant(-2), Vec3::Constant(2));
  const ShapePtr whole = box(Vec3::Constant(-5), Vec3::Constant(5));
  const ShapePtr hollow = subtract(whole, {box(Vec3::Constant(-2), Vec3::Constant(2))});
  const Mesh cavity = read_mesh(write_obj("a.obj", both(cube(), inside_out(core))), 1);
  EXPECT_EQ(sites_of(cavity), sites_of(hollow));
  EXPECT_NEAR(cavity.facts.volume, 1000 - 64, 1e-9);
  EXPECT_EQ(cavity.facts.overlap, 0);
  const Mesh turned = read_mesh(write_obj("b.obj", both(inside_out(cube()), core)), 1);
  EXPECT_EQ(sites_of(turned), sites_of(hollow));
  EXPECT_EQ(turned.facts.inside_out, 0U);
  const Mesh filled = read_mesh(write_obj("c.obj", both(cube(), core)), 1);
  EXPECT_EQ(sites_of(filled), sites_of(whole));
  EXPECT_GT(filled.facts.overlap, 0.03);
}

// Two cubes share a face, whose edges have four triangles: half go along each.
TEST_F(MeshBodies, ThatTouchAreClosed) {
  const Mesh mesh = read_mesh(write_obj("a.obj", both(cube(), cuboid({5, -5, -5}, {15, 5, 5}))), 1);
  EXPECT_TRUE(mesh.facts.closed()) << mesh_text(mesh.facts);
  EXPECT_EQ(sites_of(mesh), sites_of(box({-5, -5, -5}, {15, 5, 5})));
  EXPECT_EQ(mesh_warning(mesh.facts), "");
}

// Every second triangle is turned. All are turned back, and overlaps are as solid as ever.
TEST_F(MeshBodies, WhoseTrianglesAreTurnedAreTurnedBack) {
  Triangles t = both(cube(), cuboid({0, -2, -2}, {10, 2, 2}));
  for (size_t k = 1; k < t.corners.size(); k += 2)
    if (k % 3 != 0) std::swap(t.corners[k][1], t.corners[k][2]);
  const Mesh mesh = read_mesh(write_obj("a.obj", t), 1);
  EXPECT_GT(mesh.facts.turned, 10U);
  EXPECT_EQ(mesh.facts.one_sided, 0U);
  EXPECT_NEAR(mesh.facts.volume, 1160, 1e-9);
  EXPECT_EQ(sites_of(mesh),
            sites_of(unite({box(Vec3::Constant(-5), Vec3::Constant(5)), box({0, -2, -2}, {10, 2, 2})})));
}

// Triangles on one side of an edge end at its middle, on the other they do not: of three edges each has one
// triangle, and no ray gets through. The facts say so, and nothing warns.
TEST_F(MeshBodies, OfTJointsAreSolidWithoutAWarning) {
  Triangles t = cube();
  const std::array<uint32_t, 3> cut = t.corners[0];
  const auto middle = static_cast<uint32_t>(t.x.size());
  t.x.emplace_back(0.5 * (t.x[cut[0]] + t.x[cut[1]]));
  t.corners[0] = {cut[0], middle, cut[2]};
  t.corners.push_back({middle, cut[1], cut[2]});
  const Mesh mesh = read_mesh(write_obj("a.obj", t), 1);
  EXPECT_EQ(mesh.facts.open, 3U);
  EXPECT_NE(mesh_text(mesh.facts).find("not closed, 3 open edges"), std::string::npos)
      << mesh_text(mesh.facts);
  EXPECT_EQ(mesh_warning(mesh.facts), "");
  EXPECT_EQ(sites_of(mesh), sites_of(box(Vec3::Constant(-5), Vec3::Constant(5))));
}

}  // namespace
}  // namespace cuboct
#endif
