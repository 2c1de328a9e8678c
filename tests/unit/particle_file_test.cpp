// SPDX-License-Identifier: MIT
// Particles of files: what is read, against the same particles listed one by one; and what is refused, word
// for word.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "model/body/particle_file.h"
#include "model/scene/scene.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

constexpr const char* kXyz =
    "2\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=species:S:1:pos:R:3:velo:R:3\nAr 1 1 1 0 0 0\nAr 2 1 1 0 0 "
    "0\n"
    "2\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=species:S:1:pos:R:3:velo:R:3 pbc=\"T F T\"\n"
    "Ar 1 1.5 2 0.5 -1 2e-1\nKr +3.25 9 -1 0 0 0\n";

constexpr const char* kData =
    "LAMMPS data file via write_data, version 29 Sep 2021, timestep = 200\n\n3 atoms\n2 atom types\n\n"
    "-1 8 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\nMasses\n\n1 1\n2 1.005 # Kr\n\nPair Coeffs # lj/cut\n\n1 1 "
    "1\n2 1 1\n\n"
    "Atoms # atomic\n\n7 2 3 3.5 4 0 0 -1\n2 1 -1.5 2 2 1 0 0\n5 1 5 5 5 0 0 0\n\n"
    "Velocities\n\n5 0 0 1\n2 0.5 0 0\n7 0 2 0\n";

const std::string kReduced =
    "units = \"reduced\"\nmass = 1\n[law]\nkind = \"lj\"\nepsilon = 1\nsigma = 1\ncutoff = 2.5\n"
    "[run]\ndt = 0.001\nsteps = 1\n";
const std::string kSi =
    "mass = \"40 u\"\n[law]\nkind = \"lj\"\nepsilon = \"10 meV\"\nsigma = \"3.4 angstrom\"\ncutoff = \"8.5 "
    "angstrom\"\n"
    "[run]\ndt = \"1 fs\"\nsteps = 1\n";

class ParticleFiles : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    return made_.write(name, text);
  }
  // `keys` of [particles].
  Scene scene(const std::string& keys, const std::string& rest = kReduced) const {
    return parse_scene(rest + "[particles]\n" + keys, (folder_ / "a.toml").string());
  }
  // Without the folder.
  std::string refused(const std::string& keys, const std::string& rest = kReduced) const {
    std::string text = refused_with([&] { scene(keys, rest); });
    const std::string folder = folder_.string() + "/";
    for (size_t at = text.find(folder); at != std::string::npos; at = text.find(folder))
      text.erase(at, folder.size());
    return text;
  }
  std::string refused_xyz(const std::string& text, const std::string& keys = "") const {
    write("a.xyz", text);
    return refused("file = \"a.xyz\"\n" + keys);
  }
  // A data file with these changes.
  std::string refused_data(const std::string& what, const std::string& by) const {
    std::string text = kData;
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    write("a.data", text.replace(at, what.size(), by));
    return refused("file = \"a.data\"\n");
  }

  const test::Folder made_;
  const std::filesystem::path folder_ = made_.path();
};

TEST_F(ParticleFiles, OfExtendedXyzAreThoseThatAreListed) {
  write("a.xyz", kXyz);
  const Scene filed = scene("file = \"a.xyz\"\n");
  const Scene listed = parse_scene(kReduced +
                                       "[box]\nsize = [9, 9, 9]\nperiodic = \"xz\"\n"
                                       "[[particle]]\nposition = [1, 1.5, 2]\nvelocity = [0.5, -1, 0.2]\n"
                                       "[[particle]]\nposition = [3.25, 9, 8]\n",
                                   "b.toml");
  EXPECT_EQ(filed.body.x, listed.body.x);
  EXPECT_EQ(filed.body.v, listed.body.v);
  EXPECT_EQ(filed.body.type, listed.body.type);
  EXPECT_EQ(filed.periodic.extent, listed.periodic.extent);
  const Scene first = scene("file = \"a.xyz\"\nframe = 0\nvelocities = false\n");
  EXPECT_EQ(first.body.x, (std::vector<Vec3>{{1, 1, 1}, {2, 1, 1}}));
  EXPECT_EQ(first.periodic.extent, Vec3(9, 9, 9));  // without pbc all repeat
  // Tabs, ends of lines with \r, blank lines at the end, a mark of the encoding, no last end of line.
  write("b",
        "\xef\xbb\xbf"
        "1\r\nProperties=id:I:1:pos:R:3\r\n\t7\t1  2\t3\r\n\r\n");
  EXPECT_EQ(scene("file = \"b\"\n").body.x, (std::vector<Vec3>{{1, 2, 3}}));
  write("b", "1\nany words\nAr 1 2 3");
  EXPECT_EQ(scene("file = \"b\"\n").body.x, (std::vector<Vec3>{{1, 2, 3}}));
  // By their ids.
  write("b", "3\nProperties=pos:R:3:id:I:1\n1 0 0 9\n2 0 0 2\n3 0 0 5\n");
  EXPECT_EQ(scene("file = \"b\"\n").body.x, (std::vector<Vec3>{{2, 0, 0}, {3, 0, 0}, {1, 0, 0}}));
}

TEST_F(ParticleFiles, OfLammpsAreInTheOrderOfTheirIdsAndInTheBox) {
  write("a.data", kData);
  const Scene read = scene("file = \"a.data\"\n");
  EXPECT_EQ(read.body.x, (std::vector<Vec3>{{7.5, 2, 2}, {5, 5, 5}, {3, 3.5, 4}}));
  EXPECT_EQ(read.body.v, (std::vector<Vec3>{{0.5, 0, 0}, {0, 0, 1}, {0, 2, 0}}));
  EXPECT_EQ(read.periodic.extent, Vec3(9, 9, 9));
  EXPECT_EQ(read.periodic.origin, Vec3(-1, 0, 0));
  // The other styles: one atom at (1, 2, 3) of type 1.
  for (const auto& [style, line, spins] : {std::array<std::string, 3>{"charge", "4 1 0.5 1 2 3", ""},
                                           {"molecular", "4 9 1 1 2 3 0 0 0", ""},
                                           {"bond", "4 9 1 1 2 3", ""},
                                           {"angle", "4 9 1 1 2 3", ""},
                                           {"full", "4 9 1 0.5 1 2 3 0 0 0", ""},
                                           {"sphere", "4 1 1.0 2.5 1 2 3", " 0 0 0"},
                                           {"atomic", "4 1 1 2 3", ""}}) {
    const std::string head = "about\n1 atoms\n0 bonds\n1 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n";
    const std::string rest = line + " # a comment\n\nVelocities\n\n4 6 7 8" + spins + "\n";
    write("b.data", head + "\nAtoms # " + style + "\n\n" + rest);
    const Scene hinted = scene("file = \"b.data\"\n");
    EXPECT_EQ(hinted.body.x, (std::vector<Vec3>{{1, 2, 3}})) << style;
    EXPECT_EQ(hinted.body.v, (std::vector<Vec3>{{6, 7, 8}})) << style;
    write("b.data", head + "\nAtoms\n\n" + rest);
    EXPECT_EQ(scene("file = \"b.data\"\natom_style = \"" + style + "\"\n").body.x, hinted.body.x) << style;
  }
  write("b.data", "about\n1 atoms\n1 atom types\nAtoms # full\n\n4 9 1 0.5 1 2 3\n");
  EXPECT_EQ(scene("file = \"b.data\"\natom_style = \"full\"\n").body.x, (std::vector<Vec3>{{1, 2, 3}}));
  EXPECT_EQ(refused("file = \"b.data\"\natom_style = \"sphere\"\n"),
            "b.data:4:9: the file states that its atom style is 'full', and 'atom_style' says 'sphere'\n"
            "  hint: leave 'atom_style' out");
  write("b.data", "about\n1 atoms\n1 atom types\nAtoms\n\n4 1 1 2 3\n");
  EXPECT_EQ(refused("file = \"b.data\"\natom_style = \"full\"\n"),
            "b.data:6:10: 5 columns: a line of atom style 'full' has 7, or 10 with image flags");
  write("b.data", "about\n1 atoms\n1 atom types\nAtoms\n\n4 9 1 1 2 3\n");
  EXPECT_EQ(
      refused("file = \"b.data\"\n"),
      "a.toml:12:8: its section Atoms does not say which atom style it has: 6 columns are those of charge, "
      "molecular, bond, angle\n  hint: atom_style = \"charge\"");
}

TEST_F(ParticleFiles, HaveTheirUnits) {
  constexpr double kU = 1.66053906660e-27, kEv = 1.602176634e-19;
  struct Case {
    const char* units;
    double length, velocity;
  };
  for (const auto& [units, length, velocity] :
       {Case{"\"metal\"", 1e-10, 100},
        {"\"real\"", 1e-10, 1e5},
        {"\"ase\"", 1e-10, std::sqrt(kEv / kU)},
        {"\"si\"", 1, 1},
        {"\"cgs\"", 0.01, 0.01},
        {"\"micro\"", 1e-6, 1},
        {"\"nano\"", 1e-9, 1},
        {"{ length = \"nm\", velocity = \"nm/ps\" }", 1e-9, 1000},
        {"{ length = \"3.4 angstrom\", velocity = \"158 m/s\" }", 3.4e-10, 158}}) {
    write("a.xyz", "1\nProperties=species:S:1:pos:R:3:vel:R:3\nAr 1 2 3 4 5 6\n");
    const Scene read = scene("file = \"a.xyz\"\nunits = " + std::string(units) + "\n", kSi);
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(read.body.x[0][a] / ((a + 1) * length), 1, 1e-15) << units;
      EXPECT_NEAR(read.body.v[0][a] / ((a + 4) * velocity), 1, 1e-15) << units;
    }
  }
  // Momenta are ASE's: of the scene's mass, or of the file's.
  for (const auto& [columns, mass, v] : {std::tuple{"", "", std::sqrt(kU * kEv) / (40 * kU)},
                                         {":masses:R:1", " 40.1", std::sqrt(kU * kEv) / (40.1 * kU)}}) {
    write("a.xyz",
          fmt::format("1\nProperties=species:S:1:pos:R:3:momenta:R:3{}\nAr 1 2 3 4 0 0{}\n", columns, mass));
    EXPECT_NEAR(scene("file = \"a.xyz\"\nunits = \"ase\"\n", kSi).body.v[0][0] / (4 * v), 1, 1e-14);
  }
  // Those that a file states.
  write("a.xyz",
        "1\nProperties=species:S:1:pos:R:3:velo:R:3 units=\"Time:s pos:um velo:mm/s\"\nAr 1 2 3 4 5 6\n");
  EXPECT_EQ(scene("file = \"a.xyz\"\n", kSi).body.x[0], Vec3(1e-6, 2e-6, 3e-6));
  EXPECT_EQ(scene("file = \"a.xyz\"\n", kSi).body.v[0], Vec3(4e-3, 5e-3, 6e-3));
  EXPECT_EQ(refused("file = \"a.xyz\"\nunits = \"metal\"\n", kSi),
            "a.toml:12:9: the file states that its unit of length is 1e-06 m, and 'units' says 1e-10 m\n"
            "  hint: leave 'units' out");
  EXPECT_EQ(
      refused("file = \"a.xyz\"\n"),
      "a.toml:12:8: the file states that its unit of length is 1e-06 m, and the scene's units are reduced\n"
      "  hint: units = { length = 1, velocity = 1 } says what one of the file's is here");
  EXPECT_EQ(scene("file = \"a.xyz\"\nunits = { length = 2, velocity = 3 }\n").body.v[0], Vec3(12, 15, 18));
  EXPECT_EQ(refused("file = \"a.xyz\"\nunits = \"metal\"\n"),
            "a.toml:13:9: the scene's units are reduced: no named ones are theirs\n"
            "  hint: units = { length = 1, velocity = 1 } says what one of the file's is here");
  const std::string data = "LAMMPS data file via write_data, version 2 Aug 2023, timestep = 0, units = ";
  const std::string rest = "\n1 atoms\n1 atom types\n\nMasses\n\n1 40.2\n\nAtoms # atomic\n\n1 1 1 2 3\n";
  write("a.data", data + "real" + rest);
  EXPECT_NEAR(scene("file = \"a.data\"\n", kSi).body.x[0][2], 3e-10, 1e-25);
  write("a.data", data + "lj" + rest);
  EXPECT_EQ(refused("file = \"a.data\"\n", kSi),
            "a.toml:11:8: the file states that its units are reduced, and those of the scene are not\n"
            "  hint: units = { length = \"3.405 angstrom\", velocity = \"157 m/s\" } says what one of the "
            "file's is");
  write("a.data", "about" + rest);
  EXPECT_EQ(
      refused("file = \"a.data\"\n", kSi),
      "a.toml:11:8: the file states no units\n  hint: units = \"metal\" is angstrom and angstrom/ps, \"ase\" "
      "angstrom and ASE's velocities; or units = { length = \"nm\", velocity = \"nm/ps\" }");
  write("b.xyz", "1\nProperties=pos:R:3:vel:R:3\n1 2 3 4 5 6\n");
  EXPECT_EQ(refused("file = \"b.xyz\"\nunits = { length = \"nm\" }\n", kSi),
            "a.toml:11:8: the file has velocities, and nothing says their unit\n"
            "  hint: units = { length = ..., velocity = ... }; 'velocities = false' leaves them out");
  // A unit that is mistaken shows in the mass.
  write("a.data", "about\n1 atoms\n1 atom types\n\nMasses\n\n1 39.5\n\nAtoms # atomic\n\n1 1 1 2 3\n");
  EXPECT_EQ(refused("file = \"a.data\"\nunits = \"metal\"\n", kSi),
            "a.data:11:5: this particle has the mass 6.55913e-26 kg in the file, and 6.64216e-26 kg as "
            "'matter' of the "
            "scene\n  hint: the scene's 'mass' counts: let both agree to 1 %");
}

TEST_F(ParticleFiles, AreOfTheirMaterials) {
  const std::string materials =
      kReduced +
      "[[material]]\nname = \"argon\"\n[[material]]\nname = \"soft glue\"\nmass = 2\n"
      "region = { shape = \"half_space\", point = [2.5, 0, 0], normal = \"-x\" }\n";
  write("a.xyz", kXyz);
  const auto names = [](const Scene& scene) {
    std::string text;
    for (const uint8_t type : scene.body.type) text += scene.rule.types[type].name + ";";
    return text;
  };
  EXPECT_EQ(names(scene("file = \"a.xyz\"\nmaterials = { Ar = \"soft glue\", Kr = \"argon\" }\n", materials)),
            "soft glue;argon;");
  // One species goes by region; names of materials are those of frames.
  write("b.xyz", "2\nProperties=species:S:1:pos:R:3\nX 1 0 0\nX 3 0 0\n");
  EXPECT_EQ(names(scene("file = \"b.xyz\"\n", materials)), "argon;soft glue;");
  write("b.xyz", "2\nProperties=species:S:1:pos:R:3:material:S:1\nX 1 0 0 soft_glue\nX 3 0 0 argon\n");
  EXPECT_EQ(names(scene("file = \"b.xyz\"\n", materials)), "soft glue;argon;");
  EXPECT_EQ(refused("file = \"a.xyz\"\n", materials),
            "a.toml:18:8: the file has 'Ar', and no material of the scene has that name\n"
            "  hint: materials = { 'Ar' = \"argon\" }");
  EXPECT_EQ(refused("file = \"a.xyz\"\nmaterials = { Ar = \"argon\" }\n", materials),
            "a.toml:19:13: no material for 'Kr', which the file has\n  hint: 'Kr' = \"argon\"");
  EXPECT_EQ(refused("file = \"a.xyz\"\nmaterials = { Ar = \"argon\", Kr = \"argon\", Xe = \"argon\" }\n",
                    materials),
            "a.toml:19:48: the file has no 'Xe'\n  hint: it has Ar, Kr");
  // Masses of LAMMPS's types, of the materials they are.
  write("a.data", kData);
  EXPECT_EQ(refused("file = \"a.data\"\nmaterials = { 1 = \"argon\", 2 = \"soft glue\" }\n", materials),
            "a.data:22:5: this particle has the mass 1.005 in the file, and 2 as 'soft glue' of the scene\n"
            "  hint: the scene's 'mass' counts: let both agree to 1 %");
  // Nobody says what one of the file's masses is in units of the scene.
  EXPECT_EQ(scene("file = \"a.data\"\nunits = { length = 1, velocity = 1 }\n"
                  "materials = { 1 = \"argon\", 2 = \"soft glue\" }\n",
                  materials)
                .body.size(),
            3u);
  const std::string columns = "Properties=species:S:1:pos:R:3:masses:R:1";
  write("b.xyz", "1\n" + columns + "\nargon 1 2 3 39.95\n");
  EXPECT_EQ(scene("file = \"b.xyz\"\n").body.size(), 1u);
  write("b.xyz", "1\n" + columns + " units=\"pos:reduced\"\nargon 1 2 3 39.95\n");
  EXPECT_EQ(refused("file = \"b.xyz\"\n"),
            "b.xyz:3:7: this particle has the mass 39.95 in the file, and 1 as 'matter' of the scene\n"
            "  hint: the scene's 'mass' counts: let both agree to 1 %");
}

TEST_F(ParticleFiles, BringABox) {
  write("a.xyz", kXyz);
  const auto boxed = [&](const std::string& box) {
    return scene("file = \"a.xyz\"\n", kReduced + "[box]\n" + box);
  };
  EXPECT_EQ(boxed("periodic = \"xyz\"\n").periodic.extent, Vec3(9, 9, 9));
  EXPECT_EQ(boxed("periodic = \"y\"\n").periodic.extent, Vec3(0, 9, 0));
  EXPECT_EQ(boxed("size = [9.000001, 8, 9]\n").periodic.extent, Vec3(9.000001, 0, 9));
  EXPECT_EQ(boxed("origin = [0, 0, -3]\n").body.x[1], Vec3(3.25, 9, -1));
  EXPECT_EQ(refused("file = \"a.xyz\"\n", kReduced + "[box]\nsize = [10, 9, 9]\n"),
            "a.toml:12:8: the box is 10 m along x, and that of the particles' file 9 m\n"
            "  hint: without 'size' it is the file's; [particles] 'box = false' leaves the file's out");
  EXPECT_EQ(scene("file = \"a.xyz\"\nbox = false\n").periodic.extent, Vec3(0, 0, 0));
  EXPECT_EQ(
      refused("file = \"a.xyz\"\nbox = false\n", kReduced + "[box]\nsize = [9, 9, 9]\nperiodic = \"z\"\n"),
      "a.xyz:8:12: the particle is outside the scene's periodic box along z\n"
      "  hint: [box] is from 0 m to 9 m there, and the particle at -1 m");
  // A last bit below the box stands at its lower end.
  write("b.xyz", "1\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=pos:R:3\n-1e-30 0 27\n");
  EXPECT_EQ(scene("file = \"b.xyz\"\n").body.x[0], Vec3(0, 0, 0));
  // Beside a packing the box is the scene's.
  write("b.xyz", "1\nLattice=\"5 0 0 0 5 0 0 0 5\" Properties=pos:R:3\n0.3 0.3 0.3\n");
  const std::string packed = "[packing]\npitch = 1.12\n[box]\ncells = [3, 3, 3]\nperiodic = \"xyz\"\n";
  const Scene both = scene("file = \"b.xyz\"\n", kReduced + packed);
  ASSERT_EQ(both.body.size(), 109U);
  EXPECT_EQ(both.body.x[108], Vec3(0.3, 0.3, 0.3));
  EXPECT_NEAR(both.periodic.extent[0], 3 * 1.12 * std::sqrt(2), 1e-12);
}

TEST_F(ParticleFiles, OfExtendedXyzAreRefusedWithTheirPlace) {
  const std::string p = "1\nProperties=species:S:1:pos:R:3\n";
  EXPECT_EQ(refused_xyz(""), "a.xyz:1:1: the file is empty");
  EXPECT_EQ(refused_xyz(" \n\n"), "a.xyz:1:1: the file is empty");
  EXPECT_EQ(refused_xyz("Ar 1 2 3\n"),
            "a.xyz:1:1: the number of particles is expected here, not 'Ar 1 2 3'\n"
            "  hint: extended XYZ begins with a line that holds it alone");
  EXPECT_EQ(refused_xyz(std::string("\x7f"
                                    "ELF\0\1\2",
                                    7)),
            "a.xyz:1:1: the number of particles is expected here, not '\\x7fELF\\x00\\x01\\x02'\n"
            "  hint: extended XYZ begins with a line that holds it alone");
  EXPECT_EQ(refused_xyz("-1\n\n"),
            "a.xyz:1:1: the number of particles is expected here, not '-1'\n"
            "  hint: extended XYZ begins with a line that holds it alone");
  EXPECT_EQ(refused_xyz("0\n\n"), "a.xyz:1:1: the frame has no particle");
  EXPECT_EQ(refused_xyz("\x1f\x8b..."),
            "a.xyz:1:1: a file packed by gzip is not read\n  hint: unpack it: gunzip");
  EXPECT_EQ(refused_xyz("99999999999999999999\n"),
            "a.xyz:1:1: the number of particles must be a whole number, not "
            "'99999999999999999999'");
  EXPECT_EQ(refused_xyz("18446744073709551615\nProperties=pos:R:3\n1 2 3\n"),
            "a.xyz:4:1: the file ends behind 0 of the 18446744073709551615 particles of its frame 0");
  EXPECT_EQ(refused_xyz("1000000000000\nProperties=pos:R:3\n1 2 3\n4 5 6"),
            "a.xyz:4:6: the file ends behind 2 of the 1000000000000 particles of its frame 0");
  EXPECT_EQ(refused_xyz(kXyz + std::string("3\n\nAr 1 2 3\n")),
            "a.xyz:12:1: the file ends behind 1 of the 3 particles of its frame 2\n"
            "  hint: frame = 1 is the last one that is whole");
  EXPECT_EQ(refused_xyz(p + "Ar 1 2 3\nAr 4 5 6\n"),
            "a.xyz:4:1: a frame's number of particles is expected here, not 'Ar 4 5 6'\n"
            "  hint: line 1 says that the frame before has 1");
  EXPECT_EQ(refused_xyz(p + "Ar 1 two 3\n"), "a.xyz:3:6: the y of a particle must be a number, not 'two'");
  EXPECT_EQ(refused_xyz(p + "Ar 1 2 nan\n"), "a.xyz:3:8: the z of a particle must be a number, not 'nan'");
  EXPECT_EQ(refused_xyz(p + "Ar inf 2 3\n"), "a.xyz:3:4: the x of a particle must be a number, not 'inf'");
  EXPECT_EQ(refused_xyz(p + "Ar 1e999 2 3\n"),
            "a.xyz:3:4: the x of a particle is larger than any number that can be computed with");
  EXPECT_EQ(refused_xyz(p + "Ar 1 2\n"),
            "a.xyz:3:7: column 4 is missing, of 'pos': a line has 4 columns\n"
            "  hint: the frame has 1 particles, by its first line");
  EXPECT_EQ(refused_xyz(p + "Ar 1 2 3 4\n"),
            "a.xyz:3:10: a column too many: a line has 4 columns\n"
            "  hint: 'Properties' of the frame's second line names them");
  EXPECT_EQ(refused_xyz("1\nProperties=species:S:1:velo:R:3\nAr 1 2 3\n"),
            "a.xyz:2:1: Properties: no column 'pos:R:3'\n  hint: there are species, velo");
  EXPECT_EQ(refused_xyz("1\nProperties=species:S:1:pos:R:2\nAr 1 2\n"),
            "a.xyz:2:24: Properties: 'pos' must be pos:R:3, not pos:R:2");
  EXPECT_EQ(refused_xyz("1\nProperties=species:S:x:pos:R:3\nAr 1 2 3\n"),
            "a.xyz:2:12: Properties: no column is described by 'species:S:x'\n"
            "  hint: Properties=species:S:1:pos:R:3 has a name, a type (S, R, I, L) and a count for each");
  EXPECT_EQ(refused_xyz("1\nProperties=pos:R:3:id:I:1 Lattice=\"9 0\n1 2 3 4\n"),
            "a.xyz:2:35: the value of 'Lattice' has no end\n  hint: a quote closes it");
  EXPECT_EQ(refused_xyz("1\nProperties=pos:R:3 Lattice=\"9 0 0\"\n1 2 3\n"),
            "a.xyz:2:20: 'Lattice' has 3 numbers: it needs 9");
  const std::string tilted = "1\nLattice=\"9 0 0 1 9 0 0 0 9\" Properties=pos:R:3\n1 2 3\n";
  EXPECT_EQ(refused_xyz(tilted),
            "a.xyz:2:1: the box of the file is no cuboid along x, y and z\n"
            "  hint: a box that repeats is one; 'box = false' leaves this one out");
  EXPECT_EQ(refused_xyz(tilted, "box = false\n"), "accepted");
  EXPECT_EQ(refused_xyz("1\nLattice=\"9 0 0 0 9 0 0 0 9\" pbc=\"T T x\" Properties=pos:R:3\n1 2 3\n"),
            "a.xyz:2:38: 'pbc' is T or F for each of three axes, not 'T T x'");
  EXPECT_EQ(
      refused_xyz("1\nLattice=\"9 0 0 0 0 0 0 0 9\" Properties=pos:R:3\n1 2 3\n"),
      "a.xyz:2:1: the box repeats along y, and has no length there\n  hint: 'box = false' leaves it out");
  EXPECT_EQ(refused_xyz("2\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=pos:R:3\n1 2 3\n1 2 12\n"),
            "a.xyz:4:1: particles 0 and 1 stand at the same point\n  hint: the other one is that of line 3");
  EXPECT_EQ(refused_xyz("2\nProperties=pos:R:3:id:I:1\n1 2 3 7\n1 2 4 7\n"),
            "a.xyz:4:1: the id 7 is there twice: in line 3 too");
  EXPECT_EQ(refused_xyz(kXyz, "frame = 2\n"), "a.toml:13:9: the file has 2 frames, from 0 to 1");
  EXPECT_EQ(refused_xyz(p + "Ar 1 2 3\n", "frame = 1\n"), "a.toml:13:9: the file has one frame, 0");
  EXPECT_EQ(refused_xyz(kXyz, "atom_style = \"full\"\n"),
            "a.toml:13:14: 'atom_style' is of LAMMPS's data files, and this is extended XYZ");
  EXPECT_EQ(refused("file = \"none.xyz\"\n"),
            "a.toml:12:8: no file 'none.xyz'\n  hint: a path is counted from the directory of a.toml");
  EXPECT_EQ(refused("file = \".\"\n"),
            "a.toml:12:8: no file '.'\n  hint: a path is counted from the directory of a.toml");
  // Of a listed particle and one of the file.
  write("a.xyz", p + "Ar 1 2 3\n");
  EXPECT_EQ(refused("file = \"a.xyz\"\n[[particle]]\nposition = [1, 2, 3]\n"),
            "a.xyz:3:4: particles 0 and 1 stand at the same point");
}

TEST_F(ParticleFiles, OfLammpsAreRefusedWithTheirPlace) {
  EXPECT_EQ(refused_data("3 atoms\n", "\n"),
            "a.data:10:1: neither LAMMPS's data nor extended XYZ: no line such as '4000 atoms'\n"
            "  hint: extended XYZ begins with a line that holds the number of particles alone");
  EXPECT_EQ(refused_data("3 atoms", "3 apples"),
            "a.data:3:1: neither LAMMPS's data nor extended XYZ: '3 apples'\n"
            "  hint: the head of a data file has lines such as '4000 atoms' and '0 10 xlo xhi'");
  EXPECT_EQ(refused_data("3 atoms", "0 atoms"), "a.data:3:1: the file has no atom");
  EXPECT_EQ(refused_data("3 atoms", "-3 atoms"),
            "a.data:3:1: the number of atoms must be a whole number, not '-3'");
  EXPECT_EQ(refused_data("3 atoms", "4 atoms"), "a.data:26:1: Atoms: 3 of 4 lines are there");
  EXPECT_EQ(refused_data("3 atoms", "99999999999999 atoms"),
            "a.data:26:1: Atoms: 3 of 99999999999999 lines are there");
  EXPECT_EQ(refused_data("3 atoms", "2 atoms"),
            "a.data:24:1: more lines than Atoms has by the head of the file");
  EXPECT_EQ(refused_data("2 atom types\n", "\n"),
            "a.data:10:1: no line such as '1 atom types' is above this");
  EXPECT_EQ(refused_data("2 atom types", "2 atom types\n7 bonds"),
            "a.data:5:1: the file has bonds, which no scene has\n"
            "  hint: particles of a scene are points, and its law acts between all");
  EXPECT_EQ(refused_data("0 9 ylo", "9 9 ylo"),
            "a.data:7:3: the box ends at 9 along y, where it begins at 9");
  EXPECT_EQ(refused_data("0 9 zlo zhi", "0 9 zlo zhi\n0 1e-9 0 xy xz yz"),
            "a.data:9:3: the box of the file is no cuboid along x, y and z\n"
            "  hint: a box that repeats is one; 'box = false' leaves this one out");
  EXPECT_EQ(refused_data("2 1.005", "3 1.005"), "a.data:13:1: the type 3 is not one of 1 to 2");
  EXPECT_EQ(refused_data("2 1.005", "2 -1"), "a.data:13:3: the mass of a type must be above 0, not -1");
  EXPECT_EQ(refused_data("Atoms # atomic", "Atoms # dipole"),
            "a.data:20:9: the atom style 'dipole' is not read\n"
            "  hint: read are atomic, charge, molecular, bond, angle, full, sphere");
  EXPECT_EQ(refused_data("7 2 3 3.5 4 0 0 -1", "7 0 3 3.5 4 0 0 -1"),
            "a.data:22:3: the type 0 is not one of 1 to 2");
  EXPECT_EQ(refused_data("7 2 3 3.5 4 0 0 -1", "7 2 3 3.5 4 0 0"),
            "a.data:22:16: 7 columns: a line of atom style 'atomic' has 5, or 8 with image flags");
  EXPECT_EQ(refused_data("7 2 3 3.5 4", "7 2 3 3,5 4"),
            "a.data:22:7: the y of an atom must be a number, not '3,5'");
  EXPECT_EQ(refused_data("7 2 3", "5 2 3"), "a.data:24:5: the id 5 is there twice: in line 22 too");
  EXPECT_EQ(
      refused_data("7 2 3 3.5 4", "7 2 7.5 2 2"),
      "a.data:22:5: particles 0 and 2 stand at the same point\n  hint: the other one is that of line 23");
  EXPECT_EQ(refused_data("7 0 2 0", "8 0 2 0"), "a.data:30:1: no atom has the id 8");
  EXPECT_EQ(refused_data("7 0 2 0", "5 0 2 0"), "a.data:30:1: the velocity of atom 5 is there twice");
  EXPECT_EQ(refused_data("7 0 2 0\n", ""), "a.data:30:1: Velocities: 2 of 3 lines are there");
  EXPECT_EQ(refused_data("7 0 2 0", "7 0 2"), "a.data:30:6: 3 columns: a line of Velocities has 4");
  EXPECT_EQ(refused_data("7 0 2 0", "7 0 2 -nan"),
            "a.data:30:7: the z of a velocity must be a number, not '-nan'");
  EXPECT_EQ(refused_data("Pair Coeffs", "Bonds"),
            "a.data:15:1: a section 'Bonds' is not read\n"
            "  hint: read are Masses, Atoms and Velocities, and coefficients are left out");
  EXPECT_EQ(refused_data("Velocities", "Atoms"), "a.data:26:1: a second section Atoms");
  std::string cut = kData;
  write("a.data", cut.substr(0, cut.find("Atoms")));
  EXPECT_EQ(refused("file = \"a.data\"\n"), "a.data:20:1: the file has no section Atoms");
  write("a.data", "Velocities first\n1 atoms\n1 atom types\nVelocities\n\n1 0 0 0\n");
  EXPECT_EQ(refused("file = \"a.data\"\n"), "a.data:4:1: Velocities stand before Atoms");
  write("a.data", cut);
  EXPECT_EQ(refused("file = \"a.data\"\nframe = 1\n"), "a.toml:13:9: the file has one frame, 0");
}

// Bytes that are changed, left out and doubled: read, or refused with a place in one of the two files.
TEST_F(ParticleFiles, ThatAreSpoiltAreReadOrRefused) {
  std::mt19937_64 random(11);
  size_t read = 0, told = 0;
  for (int k = 0; k < 1500; ++k) {
    std::string text = k % 2 == 0 ? kXyz : kData;
    const uint64_t changes = 1 + random() % 3;
    for (uint64_t change = 0; change < changes; ++change) {
      const size_t at = random() % text.size();
      const char byte =
          random() % 2 == 0 ? static_cast<char>(random() % 256) : "0123456789.-+e \n\t\"=:"[random() % 21];
      switch (random() % 4) {
        case 0:
          text[at] = byte;
          break;
        case 1:
          text.erase(at, 1 + random() % 4);
          break;
        case 2:
          text.insert(at, 1, byte);
          break;
        default:
          text.resize(std::max<size_t>(at, 1));
      }
      if (text.empty()) text = " ";
    }
    const std::string path = write("spoilt", text);
    try {
      const ParticleFile file = read_particle_file(path, {});
      ++read;
      ASSERT_EQ(file.at.size(), file.size());
      ASSERT_TRUE(file.v.empty() || file.v.size() == file.size());
      ASSERT_TRUE(file.kind.empty() || file.kind.size() == file.size());
    } catch (const InputError& error) {
      ++told;
      ASSERT_NE(error.place(), nullptr) << error.what();
      ASSERT_EQ(error.told().find('\0'), std::string::npos);
    } catch (const UnknownAtomStyle&) {
      ++told;
    }
  }
  EXPECT_GT(read, 200U);
  EXPECT_GT(told, 500U);
}

}  // namespace
}  // namespace cuboct
