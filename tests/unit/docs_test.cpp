// SPDX-License-Identifier: MIT
// The reference pages of the file formats and the readers name the same keys.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "hw/arch/arch.h"
#include "model/base/error.h"
#include "model/base/output.h"
#include "model/base/unit_names.h"
#include "model/config/config.h"
#include "model/scene/scene.h"
#include "tests/support/folder.h"
#ifdef CUBOCT_HAS_STUDIES
#include "study/machines/machine_study.h"
#include "study/sweep/study.h"
#endif
#ifdef CUBOCT_HAS_FITS
#include "study/law_fit/fit_study.h"
#endif

namespace cuboct {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

// The sections "## `[name]`..." of a page, the top level under "Top level" and what precedes it; section by
// name.
std::map<std::string, std::string> sections(const std::string& page) {
  std::map<std::string, std::string> result;
  std::istringstream lines(page);
  std::string line;
  std::vector<std::string> current{""};
  while (std::getline(lines, line)) {
    if (line.starts_with("## ")) {
      current.clear();
      static const std::regex bracketed(R"(`\[+([a-z]+)\]+`)");
      for (std::sregex_iterator i(line.begin(), line.end(), bracketed), end; i != end; ++i)
        current.push_back((*i)[1]);
      if (current.empty()) current.push_back("");
    }
    for (const std::string& section : current) result[section] += line + "\n";
  }
  return result;
}

std::string in_code(const std::string& key) { return "`" + key + "`"; }

// `key` in code type somewhere in its section.
void expect_documented(const std::string& page, const std::set<std::string>& asked) {
  const auto in = sections(page);
  for (const std::string& path : asked) {
    const size_t dot = path.rfind('.');
    const std::string section = dot == std::string::npos ? "" : path.substr(0, dot);
    const std::string key = path.substr(dot == std::string::npos ? 0 : dot + 1);
    if (section == "regions" || section == "names") continue;  // that the user chose
    if (section.find("rotate") != std::string::npos) continue;
    // Tables are documented by their own section.
    if (section.empty() && in.contains(key)) continue;
    const std::string where = section == "shape" ? "geometry" : section;
    ASSERT_TRUE(in.contains(where)) << path;
    EXPECT_NE(in.at(where).find(in_code(key)), std::string::npos) << path << " is read but not documented";
  }
}

// First cells of the tables, `a`, `b`: what the page says there is. Cells with a value such as `sphere` are
// named by the heading of their column, which then is no "key".
std::set<std::string> documented(const std::string& page) {
  std::set<std::string> keys;
  for (const auto& [section, text] : sections(page)) {
    bool of_keys = false;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("|")) of_keys = false;
      if (line.starts_with("| key")) of_keys = true;
      if (!of_keys || line.starts_with("| key") || line.starts_with("|-")) continue;
      const std::string cell = line.substr(2, line.find(" |", 2) - 2);
      static const std::regex name("`([a-z_]+)`");
      for (std::sregex_iterator i(cell.begin(), cell.end(), name), end; i != end; ++i)
        keys.insert(section.empty() ? (*i)[1].str() : section + "." + (*i)[1].str());
    }
  }
  return keys;
}

// All that a page documents, and that is more than `least`.
void expect_read(const std::string& page, const std::set<std::string>& read, size_t least) {
  const auto named = documented(page);
  EXPECT_GT(named.size(), least);
  for (const std::string& key : named)
    EXPECT_TRUE(read.contains(key)) << key << " is documented but not read";
}

// All keys that readers ask for, over scenes that between them take every branch.
std::set<std::string> scene_keys() {
  const test::Folder folder;
  const std::filesystem::path path = folder.path("scene.toml");
  std::set<std::string> keys;
  record_config_keys(&keys);
  for (const char* name :
       {"rules/heat.toml", "rules/pair.toml", "rules/glass.toml", "rules/copper.toml", "templates/rule.toml"})
    read_scene(kRoot + "/scenes/" + name);
  for (const auto& entry : std::filesystem::directory_iterator(kRoot + "/scenes"))
    if (entry.path().extension() == ".toml") read_scene(entry.path().string());
  const std::string lengths = "r = [0, 1, 2]\nforce = [1, 0, 0]\ncore = 0.5\n";
  const std::string reduced = "units = \"reduced\"\nmass = 1\n";
  const std::string run = "[run]\ndt = 0.01\nsteps = 1\n";
  for (const std::string shape :
       {"shape = \"box\"\nmin = [-9, -9, -9]\nmax = [9, 9, 9]\n", "shape = \"sphere\"\nradius = 9\n",
        "shape = \"cylinder\"\nradius = 9\nlength = 9\n",
        "shape = \"capsule\"\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradius = 9\n",
        "shape = \"extrude\"\nx = [-9, 9, 0]\ny = [-9, -9, 9]\nthickness = 9\n",
        "shape = \"half_space\"\nnormal = \"z\"\n",
        "shape = \"astm_d638\"\nlength = 90\nwidth = 20\nthickness = 9\nnarrow_length = 9\nnarrow_width = "
        "9\nfillet_radius = 20\n",
        "shape = \"union\"\nof = [ { shape = \"sphere\", radius = 9 } ]\n",
        "shape = \"difference\"\nfrom = { shape = \"sphere\", radius = 9 }\nminus = [ { shape = \"sphere\", "
        "radius = 0.5, centre = [5, 0, 0] } ]\n"
        "rotate = { axis = \"x\", angle = 0.1 }\n"}) {
    std::ofstream(path) << reduced << "[law]\nkind = \"spline\"\n"
                        << lengths << "[[particle]]\nposition = [0, 0, 0]\n"
                        << "[[velocity]]\n[velocity.region]\n"
                        << shape << run;
    read_scene(path.string());
  }
  std::ofstream(path)
      << read_config_text(kRoot + "/scenes/coupon.toml")
      << "[start]\nfrom = \"there\"\n[[stage]]\nname = \"pull\"\n"
         "until = { probe = \"tension.strain\", above = 0.1 }\nparts = 2\n"
         "gravity = { from = \"[0, 0, 0] m/s^2\", to = \"[0, 0, 1] m/s^2\" }\n"
         "constraint = [{ name = \"pulled\", velocity = \"[1, 0, 0] m/s\" }, { name = \"fixed\", "
         "free = true }]\n";
  read_scene(path.string(), {.begins = true, .stage = "pull-2"});
  for (const char* deform : {"strain_rate = \"[1, 0, 0] 1/s\"", "final_strain = [0.1, 0, 0]"}) {
    std::ofstream(path)
        << "density = \"1 g/cm^3\"\npacking = { pitch = \"1 mm\" }\n"
        << "box = { cells = [4, 4, 4], periodic = \"xyz\", deform = { " << deform << " } }\n"
        << "law = { kind = \"brittle\", stiffness = \"1 MN/m\" }\n"
           "[[probe]]\nname = \"box\"\nkind = \"stress\"\nvirial = true\nvolume = \"1 mm^3\"\n"
           "[run]\nsteps = 1\n[[stage]]\nname = \"hold\"\ndeform = false\n[[stage]]\nname = \"go\"\n";
    read_scene(path.string(), {.begins = true, .stage = "hold"});
    read_scene(path.string(), {.begins = true, .stage = "go"});
  }
  std::ofstream(path)
      << "density = \"1 g/cm^3\"\nbox = { cells = [8, 8, 8] }\n"
         "packing = { pitch = \"1 mm\", grains = { size = \"4 mm\", seed = 1, texture = \"z\", closest = 0.7 "
         "} }\n"
         "law = { kind = \"brittle\", stiffness = \"1 MN/m\", fracture_energy = \"1 J/m^2\" }\n"
         "[[probe]]\nname = \"tip\"\nkind = \"crack\"\nregion = { shape = \"sphere\", radius = "
         "\"9 mm\" }\naxis = \"x\"\nstart = \"1 mm\"\nwindow = 2\nbond_length = \"1.1 mm\"\nbonds = "
         "\"start\"\n"
         "[run]\nsteps = 1\n";
  read_scene(path.string());
  for (const char* load : {"force = \"[1, 0, 0] N\"", "traction = \"[1, 0, 0] Pa\"\narea = \"1 mm^2\""}) {
    std::ofstream(path)
        << "density = \"1 g/cm^3\"\npacking = { pitch = \"1 mm\" }\nbox = { cells = [2, 2, 2] }\n"
           "law = { kind = \"brittle\", stiffness = \"1 MN/m\" }\n"
           "[[constraint]]\nname = \"pull\"\nkind = \"pulled\"\n"
        << load << "\nregion = { shape = \"sphere\", radius = \"9 mm\" }\n[run]\nsteps = 1\n";
    read_scene(path.string());
  }
  // Of a packing, and of a sheet of points in no packing.
  for (const char* rule :
       {"packing = { pitch = \"1 mm\" }\nbox = { cells = [4, 4, 4] }\n[rule]\nkind = \"lps\"\n"
        "bulk_modulus = \"40 GPa\"\npoissons_ratio = 0.2\nhorizon_pitches = 1.5\nfracture_energy = \"3 "
        "J/m^2\"\ndamage_width = 1e-5\nunbreakable = [ { shape = \"half_space\", normal = \"x\" } ]\n"
        "[[rule.slit]]\ncorner = \"[1, 0, 0] mm\"\nalong = \"[0, 2, 0] mm\"\nacross = \"[0, 0, 2] mm\"\n",
        "particle = [ { position = \"[0, 0, 0] mm\" }, { position = \"[1, 0, 0] mm\" } ]\n[rule]\n"
        "kind = \"lps\"\nyoungs_modulus = \"72 GPa\"\npoissons_ratio = 0.2\nplane = \"stress\"\nhorizon = "
        "\"3 mm\"\ninfluence_power = 1\nvolume = \"1 mm^3\"\nquadrature = \"fitted\"\nspacing = \"1 "
        "mm\"\norder = 3\nstrain = \"small\"\nsurface_correction = true\ncritical_stretch = 0.01\n"}) {
    std::ofstream(path) << "mass = \"1 g\"\n" << rule << "[run]\ndt = \"1 ns\"\nsteps = 1\n";
    read_scene(path.string());
  }
  std::ofstream(path) << "mass = \"28 u\"\ncrystal = { lattice = \"diamond\", edge = \"5.4 angstrom\" }\n"
                         "box = { cells = [2, 2, 2] }\n[rule]\nkind = \"tersoff\"\npotential = \"si_1989\"\n"
                         "[run]\nsteps = 1\n";
  read_scene(path.string());
  const std::string file = path.string() + ".xyz";
  std::ofstream(file)
      << "1\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=species:S:1:pos:R:3:velo:R:3\nAr 1 1 1 0 0 0\n";
  std::ofstream(path)
      << reduced << "[law]\nkind = \"spline\"\n"
      << lengths << "[particles]\nfile = \"" << file
      << "\"\nunits = { length = 1, velocity = 1 }\nmaterials = { Ar = \"matter\" }\nframe = 0\n"
      << run;
  read_scene(path.string());
  std::filesystem::remove(file);
  record_config_keys(nullptr);
  return keys;
}

TEST(Docs, UnitsAreThoseOfTheReader) {
  const std::string page = read_text(kRoot + "/docs/user/scene.md");
  std::smatch listed;
  ASSERT_TRUE(std::regex_search(page, listed, std::regex("Named units: `([^`]*)`")));
  EXPECT_EQ(listed[1], fmt::format("{}", fmt::join(named_units(), " ")));
}

TEST(Docs, EverySceneKeyIsDocumentedAndViceVersa) {
  const std::string page =
      read_text(kRoot + "/docs/user/scene.md") + read_text(kRoot + "/docs/user/rules.md");
  const auto keys = scene_keys();
  EXPECT_GT(keys.size(), 80U);
  expect_documented(page, keys);
  expect_read(page, keys, 50);
}

TEST(Docs, EveryArchKeyIsDocumentedAndViceVersa) {
  const std::string page = read_text(kRoot + "/docs/user/arch.md");
  std::set<std::string> keys;
  record_config_keys(&keys);
  read_arch(kRoot + "/scenes/archs/default.toml");
  parse_arch("name = \"t\"\n[boards]\nnodes = [1, 1, 1]\n", "boards");
  record_config_keys(nullptr);
  expect_documented(page, keys);
  expect_read(page, keys, 20);
}

#ifdef CUBOCT_HAS_STUDIES
// Keys of studies: those of one that takes every branch, less what the scene and arch inside it ask for.
TEST(Docs, EveryStudyKeyIsDocumentedAndViceVersa) {
  const std::string page = read_text(kRoot + "/docs/user/study.md");
  std::set<std::string> of_scene = scene_keys();
  const test::Folder folder;
  const std::filesystem::path path = folder.path("study.toml");
  std::ofstream(path) << "scene = \"" << kRoot << "/scenes/coupon.toml\"\narch = \"" << kRoot
                      << "/scenes/archs/default.toml\"\n"
                      << "[change.run]\nduration = \"1 us\"\n[truth]\n[speed]\n"
                         "[[figure]]\nkind = \"modulus\"\ncurve = \"tension.stress\"\n"
                         "[[figure]]\nkind = \"break_time\"\ncurve = \"tension.stress\"\n"
                         "[[sweep]]\npresets = [ { name = \"a\" } ]\n[search]\nguard = [4]\n";
  std::set<std::string> keys;
  record_config_keys(&of_scene);
  read_arch(kRoot + "/scenes/archs/default.toml");
  record_config_keys(&keys);
  study::read_study(path.string());
  record_config_keys(nullptr);
  std::set<std::string> asked;
  for (const std::string& key : keys)
    if (!of_scene.contains(key) && !key.starts_with("change."))
      asked.insert(key);  // names that the user chose
  EXPECT_GT(asked.size(), 40U);
  expect_documented(page, asked);
  expect_read(page, keys, 40);
}
#endif

#ifdef CUBOCT_HAS_STUDIES
// Keys that studies of machines have beside those of other studies.
TEST(Docs, EveryKeyOfStudiesOfMachinesIsDocumentedAndViceVersa) {
  const std::string page = read_text(kRoot + "/docs/user/machines.md");
  const test::Folder folder;
  const std::filesystem::path path = folder.path("machines.toml");
  std::ofstream(path) << "scene = \"" << kRoot << "/scenes/undamped_block.toml\"\n"
                      << "[[machines]]\npresets = [ { name = \"a\" } ]\n[evolve]\n";
  std::set<std::string> keys, asked{"steps", "constraints", "minimise"};
  record_config_keys(&keys);
  study::read_machine_study(path.string(),
                            {[](const std::string&) { return Technology(); },
                             [](Technology technology, const std::string&) { return technology; },
                             {}});
  record_config_keys(nullptr);
  for (const std::string& key : keys)
    if (key.starts_with("machines.") || key.starts_with("evolve.")) asked.insert(key);
  EXPECT_GT(asked.size(), 40U);
  for (const char* key : {"steps", "constraints", "minimise"}) EXPECT_TRUE(keys.contains(key)) << key;
  // [evolve] has the keys of grids: its section names its own alone.
  std::erase_if(asked, [&](const std::string& key) {
    return key.starts_with("evolve.") && asked.contains("machines." + key.substr(7));
  });
  expect_documented(page, asked);
  expect_read(page, asked, 40);
}
#endif

#ifdef CUBOCT_HAS_FITS
TEST(Docs, EveryFitKeyIsDocumentedAndViceVersa) {
  const std::string page = read_text(kRoot + "/docs/user/fit.md");
  std::set<std::string> keys, asked;
  const test::Folder folder;
  const std::filesystem::path path = folder.path("fit.toml");
  const std::string scene = kRoot + "/scenes/studies/fit_bar_scene.toml",
                    arch = kRoot + "/scenes/archs/default.toml";
  for (const std::string& target : {"file = \"" + kRoot + "/scenes/studies/acetal.csv\"",
                                    std::string("strain = [0, 0.1, 0.2]\nstress = \"[0, 1, 2] MPa\"")}) {
    std::ofstream(path) << "scene = \"" << scene << "\"\narch = \"" << arch
                        << "\"\n[change.run]\nduration = \"1 us\"\n[bounds]\n[search]\n[target]\n"
                        << target << "\n";
    std::set<std::string> of_fit, of_scene;
    record_config_keys(&of_scene);
    read_scene(scene);
    read_arch(arch);
    record_config_keys(&of_fit);
    fit::read_fit(path.string());
    record_config_keys(nullptr);
    keys.insert(of_fit.begin(), of_fit.end());
    for (const std::string& key : of_fit)
      // A law is tried in the scene before a fit begins.
      if (!of_scene.contains(key) && !key.starts_with("change.") && !key.starts_with("law."))
        asked.insert(key);
  }
  EXPECT_GT(asked.size(), 30U);
  expect_documented(page, asked);
  expect_read(page, keys, 20);
}
#endif

// "8 to 30" in the row of a key: both ends are read, one beyond each is not.
TEST(Docs, ArchRangesAreThoseOfTheReader) {
  const test::Folder folder;
  const std::filesystem::path path = folder.path("arch.toml");
  const auto accepts = [&](const std::string& section, const std::string& key, int value) {
    std::ofstream file(path);
    file << "name = \"t\"\n[" << section << "]\n";
    if (key == "nodes")
      file << "nodes = [" << value << ", 1, 1]\n";
    else
      file << (section == "boards" ? "nodes = [1, 1, 1]\n" : "") << key << " = " << value << "\n";
    file.close();
    try {
      read_arch(path.string());
    } catch (const InputError&) {
      return false;
    }
    return true;
  };
  static const std::regex row(R"(\| `([a-z_]+)` \|[^|0-9]*(\d+) to (\d+))");
  int rows = 0;
  for (const auto& [section, text] : sections(read_text(kRoot + "/docs/user/arch.md"))) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::smatch match;
      // "2^index_bits" is no range.
      line = std::regex_replace(line, std::regex("2\\^"), "");
      if (!std::regex_search(line, match, row)) continue;
      const std::string key = match[1];
      const int low = std::stoi(match[2]), high = std::stoi(match[3]);
      EXPECT_TRUE(accepts(section, key, low) && accepts(section, key, high)) << key;
      EXPECT_FALSE(accepts(section, key, low - 1) || accepts(section, key, high + 1)) << key;
      ++rows;
    }
  }
  EXPECT_EQ(rows, 22);
}

}  // namespace
}  // namespace cuboct
