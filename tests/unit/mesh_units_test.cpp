// SPDX-License-Identifier: MIT
// What mesh files state of units and axes, how fine they are, and files that crash the library that reads
// them.
#ifdef CUBOCT_MESH_DIRECTORY
#include <minizip/zip.h>

#include <cmath>

#include "model/base/guarded_reader.h"
#include "tests/support/refused_with.h"
#include "tests/unit/mesh_files.h"

namespace cuboct {
namespace {

// 30 x 20 x 10 of its units, x by y by z.
const Triangles kBrick = cuboid({0, 0, 0}, {30, 20, 10});

std::string numbers_of(const Triangles& t, bool corners) {
  std::string text;
  for (const Vec3& x : t.x)
    if (!corners) text += fmt::format("{} {} {} ", x[0], x[1], x[2]);
  for (const auto& [a, b, c] : t.corners)
    if (corners) text += fmt::format("{} {} {} ", a, b, c);
  return text;
}

class MeshUnits : public MeshFiles {
 protected:
  // `node`: what stands before the geometry, such as a <matrix>.
  std::string write_dae(const std::string& asset, const std::string& node = {}) const {
    return write("part.dae", fmt::format(R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>{}</asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="24">{}</float_array><technique_common><accessor source="#pa" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>{}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n">{}<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)",
                                         asset, numbers_of(kBrick, false), numbers_of(kBrick, true), node));
  }
  std::string write_3mf(const std::string& unit) const {
    std::string model = fmt::format(
        "<?xml version=\"1.0\"?>\n<model {} xml:lang=\"en-US\" "
        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources><object id=\"1\" "
        "type=\"model\"><mesh><vertices>",
        unit);
    for (const Vec3& x : kBrick.x)
      model += fmt::format("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", x[0], x[1], x[2]);
    model += "</vertices><triangles>";
    for (const auto& [a, b, c] : kBrick.corners)
      model += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>", a, b, c);
    model += "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>";
    const std::string types =
        "<?xml version=\"1.0\"?><Types "
        "xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
        "<Default Extension=\"rels\" "
        "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
        "<Default Extension=\"model\" "
        "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>"
        "</Types>";
    const std::string relations =
        "<?xml version=\"1.0\"?><Relationships "
        "xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship Id=\"r\" "
        "Target=\"/3D/3dmodel.model\" "
        "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    const std::string file = path("part.3mf");
    std::filesystem::remove(file);
    zipFile archive = zipOpen(file.c_str(), APPEND_STATUS_CREATE);
    const std::pair<const char*, const std::string*> parts[] = {
        {"[Content_Types].xml", &types}, {"_rels/.rels", &relations}, {"3D/3dmodel.model", &model}};
    for (const auto& [name, text] : parts) {
      const zip_fileinfo info{};
      zipOpenNewFileInZip(archive, name, &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, 6);
      zipWriteInFileInZip(archive, text->data(), static_cast<unsigned>(text->size()));
      zipCloseFileInZip(archive);
    }
    zipClose(archive, nullptr);
    return file;
  }

  // The part stands as in the file: x by y by z.
  void expect_part(const Mesh& mesh, double unit, const Vec3& shift = Vec3::Zero()) const {
    const Bounds bounds = mesh.shape->bounds();
    EXPECT_NEAR((bounds.low - unit * shift).norm(), 0, 1e-6 * unit);
    EXPECT_NEAR((bounds.high - unit * (shift + Vec3(30, 20, 10))).norm(), 0, 1e-5 * unit);
    EXPECT_NEAR(mesh.facts.volume / (6000 * std::pow(unit, 3)), 1, 1e-6);
  }
  std::string error_with(const std::string& file, const std::string& unit) const {
    return error_of(fmt::format("shape = \"mesh\"\nfile = \"{}\"\n{}", file, unit));
  }
};

TEST_F(MeshUnits, OfColladaAreObeyedAndItsAxesKept) {
  const struct {
    const char *asset, *up;
    double unit;
  } cases[] = {{"<unit name=\"u\" meter=\"0.001\"/><up_axis>Z_UP</up_axis>", "z", 1e-3},
               {"<unit name=\"inch\" meter=\"0.0254\"/><up_axis>Y_UP</up_axis>", "y", 0.0254},
               {"<unit name=\"cm\" meter=\"0.01\"/><up_axis>X_UP</up_axis>", "x", 0.01},
               {"<created>2024-01-01T00:00:00</created>", "y", 1}};  // what the standard says of none
  for (const auto& [asset, up, unit] : cases) {
    const Mesh mesh = read_mesh(write_dae(asset), std::nullopt);
    expect_part(mesh, unit);
    EXPECT_EQ(mesh.facts.unit, unit) << asset;
    EXPECT_EQ(mesh.facts.up, *up);
    EXPECT_NE(
        mesh_text(mesh.facts).find(fmt::format("; unit {:.7g} m, as the file states; {} is up", unit, up)),
        std::string::npos)
        << mesh_text(mesh.facts);
  }
  const std::string moved = "<matrix>1 0 0 5 0 1 0 -7 0 0 1 9 0 0 0 1</matrix>";
  expect_part(read_mesh(write_dae(cases[0].asset, moved), std::nullopt), 1e-3, {5, -7, 9});
}

TEST_F(MeshUnits, Of3mfAreObeyed) {
  for (const auto& [said, unit] : std::vector<std::pair<std::string, double>>{
           {"", 1e-3}, {"unit=\"millimeter\"", 1e-3}, {"unit='inch'", 0.0254}, {"unit = \"micron\"", 1e-6}}) {
    const Mesh mesh = read_mesh(write_3mf(said), std::nullopt);
    expect_part(mesh, unit);
    EXPECT_EQ(mesh.facts.unit, unit) << said;
    EXPECT_EQ(mesh.facts.up, 'z');
  }
  write_3mf("unit=\"furlong\"");
  EXPECT_NE(error_with("part.3mf", "").find("'part.3mf': it states an unknown unit, furlong"),
            std::string::npos)
      << error_with("part.3mf", "");
}

TEST_F(MeshUnits, OfAmfAreObeyed) {
  std::string points, triangles;
  for (const Vec3& x : kBrick.x)
    points += fmt::format("<vertex><coordinates><x>{}</x><y>{}</y><z>{}</z></coordinates></vertex>", x[0],
                          x[1], x[2]);
  for (const auto& [a, b, c] : kBrick.corners)
    triangles += fmt::format("<triangle><v1>{}</v1><v2>{}</v2><v3>{}</v3></triangle>", a, b, c);
  for (const auto& [said, unit] :
       std::vector<std::pair<std::string, double>>{{"", 1e-3}, {" unit=\"inch\"", 0.0254}}) {
    const Mesh mesh = read_mesh(
        write("part.amf",
              fmt::format("<?xml version=\"1.0\"?>\n<amf{}><object id=\"0\"><mesh><vertices>{}</vertices>"
                          "<volume>{}</volume></mesh></object></amf>",
                          said, points, triangles)),
        std::nullopt);
    expect_part(mesh, unit);
    EXPECT_EQ(mesh.facts.unit, unit);
    EXPECT_EQ(mesh.facts.up, 0);
  }
}

// Another unit than the file's is refused, the file's own is not; a file that states none needs one.
TEST_F(MeshUnits, ThatDisagreeAreRefused) {
  write_dae("<unit meter=\"0.001\"/><up_axis>Z_UP</up_axis>");
  const std::string error = error_with("part.dae", "unit = \"m\"");
  EXPECT_NE(
      error.find("scene.toml:12:8: 'part.dae' states that its unit is 0.001 m and that z is up, and 'unit' "
                 "says 1 m\n"),
      std::string::npos)
      << error;
  EXPECT_EQ(scene("shape = \"mesh\"\nfile = \"part.dae\"\nunit = \"mm\"").body.x,
            scene("shape = \"mesh\"\nfile = \"part.dae\"").body.x);
  write_obj("part.obj", kBrick);
  EXPECT_NE(error_with("part.obj", "").find("'part.obj': the file states no unit of length\n"),
            std::string::npos)
      << error_with("part.obj", "");
  write("part.fbx", "Kaydara FBX Binary  ");
  EXPECT_NE(
      error_with("part.fbx", "unit = \"mm\"").find("'part.fbx': its name ends in no format that is read"),
      std::string::npos)
      << error_with("part.fbx", "unit = \"mm\"");
}

// A cube of edge 10, ever farther from the origin. Floats round each face's place to 2^-24 of the distance:
// until they are refused, the volume is right to thrice what both faces of an axis may come to.
TEST_F(MeshUnits, OfCoordinatesFarAwayAreRefusedBeforeTheyCoarsen) {
  size_t read = 0, refused = 0;
  for (const double far : {0.3, 33.3, 1234.5, 3000.3, 1e4, 123456.7, 5e6, 5e9}) {
    const Triangles t = cuboid(Vec3::Constant(far), Vec3::Constant(far + 10));
    std::string text;
    for (const Vec3& x : t.x) text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", x[0], x[1], x[2]);
    for (const auto& [a, b, c] : t.corners) text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
    const std::string file = write("far.obj", text);
    try {
      const Mesh mesh = read_mesh(file, 1);
      EXPECT_NEAR(mesh.facts.volume / 1000, 1, 6 * 2e-5) << far;
      EXPECT_LE(far, 3000.3);
      ++read;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("too coarse for a body of"), std::string::npos)
          << error.what();
      EXPECT_GE(far, 1e4);
      ++refused;
    }
  }
  EXPECT_EQ(read, 4U);
  EXPECT_EQ(refused, 4U);
}

// Faces of Assimp's that made it crash or read beside its memory, and one that takes all memory.
TEST_F(MeshUnits, FilesThatCrashTheLibraryAreRefusedInALine) {
  const auto ply = [&](const char* name, const std::string& count, const std::string& faces) {
    write(name,
          fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
                      "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
                      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n{}",
                      count, faces));
    return error_with(name, "unit = \"mm\"");
  };
  EXPECT_NE(ply("negative.ply", "4", "3 0 1 -2\n3 0 1 2\n").find("triangles of points that are not there"),
            std::string::npos);
  for (const std::string& error :
       {ply("negative.ply", "4", "3 0 1 -2\n3 0 1 2\n"), ply("far.ply", "4", "3 0 1 400000\n3 0 1 2\n"),
        ply("words.ply", "4", "z E1D@\n3 0 1 2\n"), ply("many.ply", "4000000000", "3 0 1 2\n3 0 2 3\n")}) {
    EXPECT_NE(error.find("scene.toml:12:8: '"), std::string::npos) << error;
    EXPECT_LT(error.find('\n'), 200U) << error;
  }
}

// The message of a library that holds the rest of the file is cut.
TEST_F(MeshUnits, MessagesAreShort) {
  std::string text = "solid\n";
  for (int k = 0; k < 100; ++k)
    text +=
        "facet normal 0.0, 0.0, 0.0\nouter loop\nvertex 1, 2, 3\nvertex 4, 5, 6\nvertex 7, 8, "
        "0\nendloop\nendfacet\n";
  write("comma.stl", text + "endsolid\n");
  const std::string error = error_with("comma.stl", "unit = \"mm\"");
  EXPECT_NE(error.find("'comma.stl': Cannot parse string"), std::string::npos) << error;
  EXPECT_LT(error.find('\n'), 200U) << error;
}

TEST_F(MeshUnits, ReadersThatEndBadlyAreTold) {
  const auto outcome_of = [&](const std::string& script) -> std::string {
    const std::string program = write("reader", "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return refused_with(
        [&] { read_guarded(program, "file", path("result"), {.seconds = 7, .megabytes = 50}); });
  };
  EXPECT_EQ(outcome_of("[ \"$*\" = \"file " + path("result") + " 7 50\" ]"), "accepted");
  EXPECT_EQ(outcome_of("echo out; echo 'line 3: no' >&2; echo more >&2; exit 2"), "line 3: no");
  EXPECT_EQ(outcome_of("printf 'a\\033[1mb\\n' >&2; exit 2"), "a\\x1b[1mb");
  EXPECT_EQ(outcome_of("kill -SEGV $$"), "it crashes the library that reads it (Segmentation fault)");
  EXPECT_EQ(outcome_of("kill -ABRT $$"), "it crashes the library that reads it (Aborted)");
  EXPECT_EQ(outcome_of("kill -XCPU $$"), "reading it takes more than 7 s of processor time");
  EXPECT_EQ(outcome_of("kill -ALRM $$"), "reading it takes more than 70 s");
  EXPECT_EQ(outcome_of("exit 3"), "reading it fails with code 3");
}

}  // namespace
}  // namespace cuboct
#endif
