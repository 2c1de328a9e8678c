// SPDX-License-Identifier: MIT
// Studies of macro-elements from their files: what is refused, runs that were cut, meshes of Gmsh, and the
// page that names the keys.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "model/atoms/multiscale/mesh_file.h"
#include "model/base/error.h"
#include "model/config/config.h"
#include "model/run/element_run.h"
#include "tests/support/folder.h"

namespace cuboct {
namespace {

const std::string kMaterial =
    "[material]\npotential = \"si_erhart_albe\"\nedge = \"5.43 angstrom\"\nmass = \"28.0855 u\"\ncells = 1\n";
const std::string kBar =
    kMaterial +
    "[mesh]\ncubes = [2, 2, 2]\nsize = \"[1, 1, 1] um\"\nrepeats = \"x\"\n[grains]\nsets = 2\n"
    "[samples]\nstrain_tolerance = 1e-4\n[stretch]\naxis = \"x\"\nstrains = [0.001, 0.002, 0.003]\n";
const std::string kRod =
    kMaterial +
    "[mesh]\ncubes = [12, 1, 1]\nsize = \"[12, 1, 1] um\"\n[samples]\nstrain_tolerance = 2e-5\n"
    "[wave]\nalong = \"x\"\npeak = \"10 MPa\"\npulse = \"0.3 ns\"\nsnapshots = \"[0.5, 1] ns\"\n";

const std::string kSprings =
    "crystal = \"fcc\"\nsprings = { C11 = \"160 GPa\", C12 = \"60 GPa\", C44 = \"80 GPa\" }";
const std::string kCompare =
    "[compare]\nrefine = [1, 2]\ncells = [1, 2]\nstrain_tolerance = [0, 1e-4]\n"
    "force = [\"1e-4 eV/angstrom\", \"1e-6 eV/angstrom\"]\n";

using test::Folder;

ElementStudy study_of(const std::string& text) {
  const Folder folder;
  return read_element_study(folder.write("study.toml", text));
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// The message without the path before it.
std::string refusal(const std::string& text) {
  try {
    study_of(text);
  } catch (const InputError& error) {
    const std::string what = error.what();
    const size_t at = what.find("study.toml");
    return at == std::string::npos ? what : what.substr(at);
  }
  return "";
}

TEST(ElementStudy, SaysWhereAFileIsWrong) {
  EXPECT_EQ(refusal(kBar), "");
  EXPECT_EQ(refusal(changed(kBar, "[2, 2, 2]", "[3, 2, 2]")),
            "study.toml:7:9: along x, which repeats, the number of cubes must be even, not 3\n"
            "  hint: the division into tetrahedra is mirrored in every second cube");
  EXPECT_EQ(refusal(changed(kBar, "axis = \"x\"", "axis = \"y\"")),
            "study.toml:15:8: the mesh does not repeat along y\n  hint: name it in mesh.repeats");
  EXPECT_NE(
      refusal(changed(kBar, "sets = 2", "sets = 2\norientation = { along = [1, 0, 0] }")).find("are one set"),
      std::string::npos);
  EXPECT_NE(refusal(changed(kBar, "strains", "strain")).find("study.toml:"), std::string::npos);
  EXPECT_NE(refusal(changed(kBar, "si_erhart_albe", "si_1898")).find("did you mean 'si_1988'"),
            std::string::npos);
  EXPECT_EQ(refusal(changed(kBar, "0.002", "-1e-308")),
            "study.toml:16:11: a strain of -1e-308 is lost in the rounding of positions: 1e-09 at least");
  const std::string empty = ::testing::TempDir() + "cuboct_no_entry.tersoff";
  std::ofstream(empty) << "# none\n";
  EXPECT_EQ(refusal(changed(kBar, "potential = \"si_erhart_albe\"", "file = \"" + empty + "\"")),
            "study.toml:2:8: " + empty + " has no entry for Si Si Si");
  EXPECT_NE(
      refusal(kMaterial + "[mesh]\ncubes = [1, 1, 1]\nsize = \"[1, 1, 1] um\"\n").find("nothing to study"),
      std::string::npos);
}

TEST(ElementStudy, RefusesComparisonsThatSayNothing) {
  const std::string grains = changed(kBar, "sets = 2", "sets = 2\ncubes = 1");
  EXPECT_EQ(refusal(grains + kCompare), "");
  EXPECT_NE(refusal(kBar + kCompare)
                .find("each make another polycrystal when they are cut\n"
                      "  hint: give grains.cubes = 1, or more"),
            std::string::npos);
  EXPECT_NE(refusal(grains + "[compare]\ncells = [2]\n").find("one point alone compares with nothing"),
            std::string::npos);
  EXPECT_NE(refusal(grains + "[compare]\nrefine = [0]\n").find("study.toml:19:11: "), std::string::npos);
  EXPECT_NE(refusal(changed(kBar, "potential", kSprings + "\npotential")).find("springs"), std::string::npos);
  EXPECT_NE(refusal(changed(kBar, "potential = \"si_erhart_albe\"", changed(kSprings, "160", "100")))
                .find("C11 is not above 2 C44\n"),
            std::string::npos);
}

// The grid holds each combination once; a refined mesh has the same grains in the same places.
TEST(ElementStudy, ComparesTheSameGrains) {
  const Folder folder;
  const std::string path =
      folder.write("a.toml", changed(kBar, "sets = 2", "sets = 2\ncubes = 1") + kCompare);
  const ElementStudy own = read_element_study(path);
  const std::vector<ElementEffort> efforts = efforts_of(*own.compare);
  ASSERT_EQ(efforts.size(), 16U);
  EXPECT_EQ(std::ranges::count(efforts, finest(*own.compare)), 1);
  EXPECT_EQ(finest(*own.compare).refine, 2);
  std::set<uint64_t> hashes{own.hash};
  for (const ElementEffort& effort : efforts) hashes.insert(read_element_study(path, effort).hash);
  EXPECT_EQ(hashes.size(), 17U);
  const ElementStudy fine = read_element_study(path, finest(*own.compare));
  EXPECT_EQ(fine.material.cells, 2);
  EXPECT_EQ(fine.strain_tolerance, 0);
  ASSERT_EQ(fine.mesh.elements.size(), 8 * own.mesh.elements.size());
  ASSERT_EQ(fine.mesh.grains(), own.mesh.grains());
  const auto centres = [](const ElementMesh& mesh) {
    std::vector<Vec3> sum(mesh.grains(), Vec3::Zero());
    for (size_t e = 0; e < mesh.elements.size(); ++e)
      for (const auto& corner : mesh.elements[e])
        sum[mesh.grain[e]] += element_volume(mesh, e) / 4 * corner_place(corner, mesh.x, mesh.period);
    return sum;
  };
  for (uint32_t g = 0; g < own.mesh.grains(); ++g)
    EXPECT_LT((centres(own.mesh)[g] - centres(fine.mesh)[g]).norm(), 1e-6 * centres(own.mesh)[g].norm());
}

void expect_same(const SetOutcome& a, const SetOutcome& b) {
  ASSERT_EQ(a.stretch.size(), b.stretch.size());
  for (size_t k = 0; k < a.stretch.size(); ++k) {
    EXPECT_EQ(a.stretch[k].stress, b.stretch[k].stress);
    EXPECT_EQ(a.stretch[k].expansion, b.stretch[k].expansion);
  }
  ASSERT_EQ(a.wave.front.size(), b.wave.front.size());
  for (size_t k = 0; k < a.wave.front.size(); ++k) EXPECT_EQ(a.wave.front[k].time, b.wave.front[k].time);
  ASSERT_EQ(a.wave.snapshots.size(), b.wave.snapshots.size());
  for (size_t k = 0; k < a.wave.snapshots.size(); ++k)
    EXPECT_EQ(a.wave.snapshots[k].points, b.wave.snapshots[k].points);
  EXPECT_EQ(a.work.relaxations, b.work.relaxations);
  EXPECT_EQ(a.work.evaluations, b.work.evaluations);
}

// Cut twice, anywhere, and on two threads, a study ends with the bits of one that was not.
TEST(ElementRun, GoesOnWhereItWasCut) {
  for (const std::string& text : {kBar, kRod}) {
    const ElementStudy study = study_of(text);
    const auto material = material_of(study);
    const std::vector<SetOutcome> whole = run_elements(study, material, {});
    ASSERT_EQ(whole.size(), study.sets);
    const Folder folder;
    ElementRunOptions options;
    options.threads = 2;
    options.progress = folder.path("progress");
    std::vector<SetOutcome> parts;
    int calls = 0, cuts = 0;
    while (parts.empty()) {
      calls = 0;
      options.see = [&](size_t, double) { return ++calls < (cuts < 2 ? 2 + 5 * cuts : 1 << 30); };
      try {
        parts = run_elements(study, material, options);
      } catch (const ElementRunStopped&) {
        ++cuts;
      }
    }
    EXPECT_EQ(cuts, text == kRod ? 2 : 1 + (whole[0].stretch.size() * study.sets > 8));
    ASSERT_EQ(parts.size(), whole.size());
    for (size_t k = 0; k < whole.size(); ++k) expect_same(whole[k], parts[k]);
    EXPECT_THROW(run_elements(study_of(text + "# another\n"), material, options), InputError);
    std::filesystem::resize_file(options.progress, std::filesystem::file_size(options.progress) - 8);
    EXPECT_THROW(run_elements(study, material, options), InputError);
  }
}

TEST(ElementRun, OfARodGivesASpeedAndSnapshots) {
  const ElementStudy study = study_of(kRod);
  const auto material = material_of(study);
  const SetOutcome out = run_elements(study, material, {})[0];
  // 12 elements to a rod show a speed within some per cent of sqrt(E/rho).
  EXPECT_NEAR(out.wave.speed.speed / rod_speed(hill_mean(material->constants), material->lattice.density()),
              1, 0.1);
  ASSERT_EQ(out.wave.snapshots.size(), 2U);
  EXPECT_EQ(out.wave.snapshots[0].points.size(), 13 * 2U);
}

// A tetrahedron cut in four about an inner node, in both formats.
const std::string kNodes = "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0.2 0.2 0.2\n";
const std::string kMsh2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n" + kNodes +
                          "$EndNodes\n$Elements\n5\n1 2 2 0 7 1 2 3\n2 4 2 0 8 5 2 3 4\n3 4 2 0 3 1 5 3 4\n"
                          "4 4 2 0 3 1 2 5 4\n5 4 2 0 3 1 2 3 5\n$EndElements\n";
const std::string kMsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n2 5 1 5\n0 1 0 1\n1\n0 0 0\n3 3 0 4\n2\n3\n4\n5\n"
    "1 0 0\n0 1 0\n0 0 1\n0.2 0.2 0.2\n$EndNodes\n$Elements\n3 5 1 5\n2 7 2 1\n1 1 2 3\n3 8 4 1\n2 5 2 3 4\n"
    "3 3 4 3\n3 1 5 3 4\n4 1 2 5 4\n5 1 2 3 5\n$EndElements\n";

TEST(Gmsh, ReadsBothFormats) {
  const Folder folder;
  for (const std::string& text : {kMsh2, kMsh4}) {
    const ElementMesh mesh = read_gmsh(folder.write("a.msh", text), 1e-6, {});
    ASSERT_EQ(mesh.elements.size(), 4U);
    EXPECT_EQ(mesh.grain, (std::vector<uint32_t>{1, 0, 0, 0}));
    double volume = 0;
    for (size_t e = 0; e < 4; ++e) volume += element_volume(mesh, e);
    EXPECT_NEAR(volume, 1e-18 / 6, 1e-30);
  }
}

// A box that is written out and read with axes that repeat is the box that repeats.
TEST(Gmsh, JoinsFacesThatRepeat) {
  const ElementMesh open = box_mesh({2, 2, 2}, {2, 3, 2}, {}, 100);
  std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", open.x.size());
  for (size_t v = 0; v < open.x.size(); ++v)
    text += fmt::format("{} {} {} {}\n", v + 1, open.x[v][0], open.x[v][1], open.x[v][2]);
  text += fmt::format("$EndNodes\n$Elements\n{}\n", open.elements.size());
  for (size_t e = 0; e < open.elements.size(); ++e) {
    const auto& c = open.elements[e];
    text += fmt::format("{} 4 2 1 1 {} {} {} {}\n", e + 1, c[0].vertex + 1, c[1].vertex + 1, c[2].vertex + 1,
                        c[3].vertex + 1);
  }
  const Folder folder;
  const ElementMesh joined =
      read_gmsh(folder.write("box.msh", text + "$EndElements\n"), 1, {true, false, true});
  // Vertex 3 of the upper face has no counterpart.
  const std::string moved = changed(text, "\n3 2 0 0\n", "\n3 2 0.5 0\n");
  try {
    read_gmsh(folder.write("moved.msh", moved + "$EndElements\n"), 1, {true, false, false});
    ADD_FAILURE() << "joined";
  } catch (const InputError& error) {
    EXPECT_NE(
        std::string(error.what()).find("moved.msh:8:1: vertex 3 of the upper face along x has none across"),
        std::string::npos)
        << error.what();
  }
  const ElementMesh expected = box_mesh({2, 2, 2}, {2, 3, 2}, {true, false, true}, 100);
  EXPECT_EQ(joined.x, expected.x);
  EXPECT_EQ(joined.period, expected.period);
  for (size_t e = 0; e < expected.elements.size(); ++e)
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(joined.elements[e][k].vertex, expected.elements[e][k].vertex);
      EXPECT_EQ(joined.elements[e][k].image, expected.elements[e][k].image);
    }
}

TEST(Gmsh, RefusesWhatIsNoMeshOfTetrahedra) {
  const Folder folder;
  const auto told = [&](const std::string& text) {
    try {
      read_gmsh(folder.write("a.msh", text), 1, {});
    } catch (const InputError& error) {
      const std::string what = error.what();
      return what.substr(what.find("a.msh"));
    }
    return std::string();
  };
  EXPECT_EQ(
      told(changed(kMsh2, "8 5 2 3 4", "8 5 2 4 3")),
      "a.msh:15:1: element 1 is inverted: its volume is -0.0667 m^3\n  hint: exchange two of its vertices");
  EXPECT_EQ(told(changed(kMsh2, "5\n" + kNodes, "6\n" + kNodes + "6 9 9 9\n")),
            "a.msh:11:1: vertex 6 belongs to no element\n  hint: a vertex without an element has no mass and "
            "no force");
  EXPECT_EQ(told(changed(kMsh2, "2 4 2 0 8 5 2 3 4", "2 5 2 0 8 5 2 3 4 1 2 3 4")),
            "a.msh:15:1: element 2 is of type 5: elements are tetrahedra of four nodes");
  EXPECT_EQ(told(changed(kMsh2, "3 4 2 0 3 1 5 3 4", "3 4 2 0 3 1 5 3 9")),
            "a.msh:16:1: element 3 has node 9, which is not there");
  EXPECT_EQ(told(changed(kMsh2, "2.2 0 8", "2.2 1 8")),
            "a.msh:2:1: the file is binary: write it as text (gmsh -bin 0)");
  EXPECT_EQ(told("solid\n"), "a.msh:2:1: no $MeshFormat: this is no file of Gmsh");
  EXPECT_NE(told(kMsh2.substr(0, kMsh2.size() / 2)), "");
}

// All keys that readers ask for stand in the page's tables, and all that stand there are asked for.
TEST(ElementStudy, PageNamesEveryKeyAndNoOther) {
  const Folder folder;
  std::set<std::string> asked;
  record_config_keys(&asked);
  read_element_study(folder.write(
      "a.toml", changed(kBar, "sets = 2", "orientation = { along = [1, 1, 0], up = [0, 0, 1] }")));
  read_element_study(folder.write("b.toml", kRod));
  const std::string inline_set =
      "parameters = { A = 3821.34, B = 113.17, lambda1 = 3.36252, lambda2 = 1.27279, lambda3 = 1.19417, "
      "beta = 0.132272, n = 4.16334, gamma = 5.71477, c = 9.69902, d = 2.35646, cos_theta0 = -0.40882, R = "
      "2.85, D = 0.15 }";
  folder.write("c.msh", kMsh2);
  read_element_study(folder.write(
      "c.toml", changed(changed(kRod, "potential = \"si_erhart_albe\"", inline_set),
                        "cubes = [12, 1, 1]\nsize = \"[12, 1, 1] um\"", "file = \"c.msh\"\nunit = \"um\"")));
  read_element_study(folder.write(
      "d.toml", changed(changed(kBar, "potential = \"si_erhart_albe\"", kSprings), "sets = 2", "cubes = 1") +
                    kCompare));
  record_config_keys(nullptr);
  std::ifstream in(CUBOCT_SOURCE_DIR "/docs/user/multiscale.md");
  std::set<std::string> named;
  std::string section;
  for (std::string line; std::getline(in, line);) {
    static const std::regex heading(R"(### `\[([a-z]+)\]`)"), name("`([A-Za-z_0-9]+)`");
    std::smatch found;
    if (line.starts_with("## ")) section.clear();
    if (line.starts_with("### Top")) section = "top";
    if (std::regex_search(line, found, heading)) section = found[1];
    if (section.empty() || !line.starts_with("| `")) continue;
    const std::string cell = line.substr(0, line.find(" |", 2));
    std::regex_search(cell, found, name);
    named.insert(section == "top" ? found[1].str() : section + "." + found[1].str());
  }
  EXPECT_GT(named.size(), 25U);
  for (const std::string& key : asked) {
    if (key == "units" || key.find('.') == std::string::npos) {
      EXPECT_TRUE(key == "units" || named.contains(key) ||
                  std::ranges::any_of(named, [&](const std::string& n) { return n.starts_with(key + "."); }))
          << key;
      continue;
    }
    const bool nested = key.find('.', key.find('.') + 1) != std::string::npos;
    EXPECT_TRUE(nested || named.contains(key)) << key << " is not on the page";
  }
  for (const std::string& key : named) EXPECT_TRUE(asked.contains(key)) << key << " is not read";
}

}  // namespace
}  // namespace cuboct
