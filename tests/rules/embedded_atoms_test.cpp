// SPDX-License-Identifier: MIT
// Embedded atoms as a rule of text: the readers of potential files, the tables, energies and forces. Numbers
// of LAMMPS are of its files (Debian: lammps-data); where they are not installed, their tests are skipped.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "model/base/error.h"
#include "model/program/potential_file.h"
#include "model/run/rounds_run.h"
#include "tests/rules/metal.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

using test::energy_of;
using test::fcc_crystal;
using test::kEv;
using test::metal_scene;

const std::string kCopper = CUBOCT_SOURCE_DIR "/scenes/rules/texts/copper.eam.alloy";
const std::string kOwnFile = "file = \"texts/copper.eam.alloy\"";
const std::string kPotentialFiles = CUBOCT_POTENTIALS;

// x^2 at 0, 1 ... 5. The slope at 0 is that of the first step, at 1 and 4 that of two steps, at 5 that of the
// last; at 2 and 3, of five values, it is exact.
TEST(CubicTable, HasLammpsSlopes) {
  const CubicTable table("squares", 1, {0, 1, 4, 9, 16, 25}, true);
  EXPECT_DOUBLE_EQ(table.slope(0), 1);
  EXPECT_DOUBLE_EQ(table.at(0.5), 0.375);  // p - p^2 + p^3, slopes 1 and 2
  EXPECT_DOUBLE_EQ(table.at(2.5), 6.25);
  EXPECT_DOUBLE_EQ(table.slope(2.5), 5);
  EXPECT_DOUBLE_EQ(table.slope(4), 8);
  EXPECT_DOUBLE_EQ(table.at(4.5), 20.375);  // 16 + 8 p + 2 p^2 - p^3, slopes 8 and 9
  EXPECT_DOUBLE_EQ(table.slope(5), 9);
  // Beyond the end as at the end; below 0 the first cubic goes on.
  EXPECT_DOUBLE_EQ(table.at(7), 25);
  EXPECT_DOUBLE_EQ(table.at(-0.5), -0.875);
  EXPECT_TRUE(table.beyond(5.1));
  EXPECT_TRUE(table.beyond(NAN));
  EXPECT_FALSE(table.beyond(5));
  EXPECT_EQ(table.range(false), (std::pair<double, double>{0, 25}));
  // Five-point slopes are exact for a fourth power: 108 at 3, where two points would give 120.
  EXPECT_DOUBLE_EQ(CubicTable("powers", 1, {0, 1, 16, 81, 256, 625, 1296}, true).slope(3), 108);
}

EmbeddedAtoms read_text(const std::string& text, const std::vector<std::string>& elements = {}) {
  return read_embedded_atoms(test::Folder().write("cuboct_eam_", text), elements, false);
}

const std::string kSetfl =
    "DATE: today UNITS: metal\nsecond\n\n2 Aa Bb\n6 0.5 6 0.1 0.5\n"
    "1 1.5 4.0 fcc\n0 -1 -2 -3\n-4 -5\n5 4 3 2 1 0\n"
    "2 2.5 0.0 bcc\n0 -2 -4 -6 -8 -10\n10 8 6 4 2 0\n"
    "1 1 1 1 1 1\n2 2 2 2 2 2\n3 3 3 3 3 +3.0\n";

TEST(PotentialFile, SetflHasElementsInAnyOrder) {
  const EmbeddedAtoms both = read_text(kSetfl, {"Bb", "Aa"});
  EXPECT_EQ(both.elements, (std::vector<std::string>{"Bb", "Aa"}));
  EXPECT_DOUBLE_EQ(both.cutoff, 0.5);
  EXPECT_DOUBLE_EQ(both.embedding[0]->at(1), -4);
  EXPECT_DOUBLE_EQ(both.embedding[1]->at(1), -2);
  EXPECT_DOUBLE_EQ(both.density[0]->at(0.1), 8);
  EXPECT_DOUBLE_EQ(both.pair[0]->at(0.3), 3);
  EXPECT_DOUBLE_EQ(both.pair[1]->at(0.3), 2);
  EXPECT_DOUBLE_EQ(both.pair[2]->at(0.3), 2);
  EXPECT_DOUBLE_EQ(both.pair[3]->at(0.3), 1);
  EXPECT_DOUBLE_EQ(read_text(kSetfl, {"Aa"}).lattice_constant, 4);
  EXPECT_NE(both.hash, read_text(kSetfl, {"Aa", "Bb"}).hash);
  std::string other = kSetfl;
  other.replace(other.find("+3.0"), 4, "3.01");
  EXPECT_NE(both.hash, read_text(other, {"Bb", "Aa"}).hash);
}

// Z(r) = 2 everywhere: r times the energy is 27.2 * 0.529 * 4. The last value of a table is left out.
TEST(PotentialFile, FuncflHasCharges) {
  const EmbeddedAtoms one = read_text(
      "a comment\n29 63.55 3.615 FCC\n6 0.5 7 0.1 0.5\n0 -1 -2 -3 -4 -5\n2 2 2 2 2 2 2\n6 5 4 3 2 1 0\n");
  EXPECT_DOUBLE_EQ(one.pair[0]->at(0.25), 27.2 * 0.529 * 4);
  EXPECT_DOUBLE_EQ(one.pair[0]->end(), 0.5);
  EXPECT_DOUBLE_EQ(one.embedding[0]->end(), 2);
  EXPECT_DOUBLE_EQ(one.density[0]->at(0.2), 4);
  EXPECT_DOUBLE_EQ(one.lattice_constant, 3.615);
}

std::string refusal_of(const std::string& text, const std::vector<std::string>& elements = {"Aa"}) {
  try {
    read_text(text, elements);
  } catch (const InputError& error) {
    const std::string what = error.what();
    const size_t at = what.find(':', what.find("cuboct_eam_"));
    return what.find(' ') < at ? what : what.substr(at + 1);
  }
  return "none";
}

TEST(PotentialFile, OfAStrangerEndsInAnErrorAtItsPlace) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kSetfl;
    return text.replace(text.find(from), from.size(), to);
  };
  const auto says = [](const std::string& text, const std::string& what) {
    const std::string said = refusal_of(text);
    EXPECT_TRUE(said.starts_with(what)) << said;
  };
  says("", "1:1: neither a setfl file nor a funcfl file");
  says(std::string(100, '\n'), "4:1: neither a setfl file");
  says(std::string("\0\1\2\n\377\n\n\n", 8), "4:1: neither a setfl file");
  says(with("metal", "real"), "1:20: a file in units 'real' is not read");
  says(with("2 Aa Bb", "3 Aa Bb"), "4:1: 3 elements, but 2 names");
  says(with("2 Aa Bb", "1e9 Aa Bb"), "4:1: the number of elements must be a whole number from 1 to 32");
  says(with("6 0.5 6", "6 0.5"), "5:1: the numbers of values, their steps and the cutoff");
  says(with("6 0.5 6", "999999999999 0.5 6"), "5:1: the number of densities must be a whole number");
  says(with("6 0.5 6", "6 -0.5 6"), "5:3: the step of densities must be positive, not -0.5");
  says(with("0.1 0.5", "nan 0.5"), "5:9: the step of distances must be a number, not 'nan'");
  says(with("0.1 0.5", "0.1 0.7"), "5:13: the cutoff, 0.7, is beyond the last distance, 0.6");
  says(with("1 1.5 4.0 fcc\n", ""), "6:3: the mass must be positive, not -1");
  says(with("2 2.5 0.0 bcc", "0.5 0.4 0.3 0.2"), "10:1: the line of the element Bb is expected here");
  says(with("-1 -2", "-1 x2"), "7:6: the embedding energy of Aa, value 3 of 6 must be a number, not 'x2'");
  says(with("-1 -2", "-1 1e400"), "7:6: the embedding energy of Aa, value 3 of 6 must be a number");
  says(with(" +3.0\n", ""), "15:10: the file ends in the pairs of Bb and Bb, value 6 of 6");
  EXPECT_EQ(refusal_of(with("-1 -2", "-1 1e-400")), "none");
  const std::string funcfl =
      "a comment\n29 63.55 3.615 FCC\n6 0.5 7 0.1 0.5\n0 -1 -2 -3 -4 -5\n2 2 2 2 2 2 2\n6 5 4 3 2 1 0\n";
  EXPECT_EQ(refusal_of(funcfl), "none");
  const std::string several = refusal_of(funcfl, {"Aa", "Bb"});
  EXPECT_NE(several.find("is a funcfl file, which has one element, not Aa, Bb\n  hint: a setfl file has"),
            std::string::npos)
      << several;
  EXPECT_NE(refusal_of(kSetfl, {"Cc"}).find("has no element 'Cc'"), std::string::npos);
  EXPECT_NE(refusal_of(kSetfl, {}).find("has several elements: Aa, Bb"), std::string::npos);
}

TEST(PotentialFile, OfAStrangerDoesNoHarm) {
  std::mt19937_64 random(9);
  const std::string marks = " \n-+.e019x#\t\r\377";
  size_t read = 0, refused = 0;
  for (int k = 0; k < 1000; ++k) {
    std::string text = kSetfl;
    for (int n = 0; n < 3; ++n) text[random() % text.size()] = marks[random() % marks.size()];
    if (k % 5 == 0) text.resize(random() % text.size());
    refusal_of(text) == "none" ? ++read : ++refused;
  }
  EXPECT_GT(read, 40u);
  EXPECT_GT(refused, 300u);
}

// The form of scenes/rules/texts/copper.py: a file of ten digits and its cubics are off by less than 1e-6.
TEST(PotentialFile, OfThisTreeIsItsClosedForm) {
  const EmbeddedAtoms copper = read_embedded_atoms(kCopper, {}, false);
  const auto cube = [](double x) { return x > 0 ? x * x * x : 0; };
  for (double r = 1.9; r < 4.5; r += 0.07) {
    const double x = r / 3.615;
    EXPECT_NEAR(copper.density[0]->at(r), 9.806694 * cube(1.2247449 - x) + 16.774638 * cube(1 - x), 1e-6)
        << r;
    const double pair = 29.059214 * cube(1.2247449 - x) - 140.05681 * cube(1.1547054 - x) +
                        130.07331 * cube(1.1180065 - x) - 17.48135 * cube(1 - x) +
                        31.82546 * cube(0.8660254 - x) + 71.58749 * cube(0.7071068 - x);
    EXPECT_NEAR(copper.pair[0]->at(r), r * pair, 1e-6) << r;
  }
  EXPECT_NEAR(copper.embedding[0]->at(22.05), -std::sqrt(22.05), 1e-8);
}

// GPa, by energies of crystals strained by 1e-4.
struct Constants {
  double c11, c12, c44;
};
Constants constants_of(const Rule& rule, double a, int cells) {
  constexpr double kStrain = 1e-4;
  const auto second = [&](bool turned, const Vec3& strain) {
    const auto energy = [&](double sign) {
      return energy_of(rule, fcc_crystal(a, cells, turned, Vec3::Ones() + sign * strain));
    };
    const Vec3 box = fcc_crystal(a, cells, turned).periodic.extent / test::kAngstrom;
    return (energy(1) - 2 * energy(0) + energy(-1)) / (kStrain * kStrain * box.prod()) * 160.2176634;
  };
  const double c11 = second(false, Vec3(kStrain, 0, 0)), both = second(false, Vec3(kStrain, kStrain, 0));
  const double c12 = both / 2 - c11;
  // Along [110] the modulus is (C11 + C12 + 2 C44)/2.
  return {c11, c12, second(true, Vec3(kStrain, 0, 0)) - (c11 + c12) / 2};
}

struct Anchor {
  const char* potential;  // file, and more keys
  const char* more;
  double a, energy, c11, c12, c44;
};
// LAMMPS 29 Sep 2021, with these files, strain 1e-4. a in angstrom, eV an atom, GPa.
const Anchor kAnchors[] = {
    {"Cu_u3.eam", "", 3.615000, -3.540000, 167.26, 124.15, 76.45},
    {"Cu_u6.eam", "", 3.615000, -3.540000, 168.06, 123.75, 78.85},
    {"Cu_mishin1.eam.alloy", "", 3.614925, -3.540218, 169.88, 122.58, 76.21},
    {"CuTa.eam.alloy", ", element = \"Cu\"", 3.614939, -3.539994, 161.91, 118.07, 72.02},
    {"Ag_u3.eam", "", 4.090000, -2.850000, 129.14, 91.04, 56.79},
};

TEST(EmbeddedAtoms, CrystalsAreThoseOfLammps) {
  if (kPotentialFiles.empty()) GTEST_SKIP() << "no potential files of LAMMPS (Debian: lammps-data)";
  for (const Anchor& anchor : kAnchors) {
    SCOPED_TRACE(anchor.potential);
    const int cells = 4;
    const Scene scene = metal_scene(
        fmt::format("file = \"{}/{}\"{}", kPotentialFiles, anchor.potential, anchor.more), anchor.a, cells);
    const auto per_atom = [&](double a) {
      const test::Crystal crystal = fcc_crystal(a, cells, false);
      return energy_of(scene.rule, crystal) / static_cast<double>(crystal.body.size());
    };
    EXPECT_NEAR(per_atom(anchor.a), anchor.energy, 1e-6);
    // Where the slope of the energy is 0: six digits of a, and the noise of a difference.
    constexpr double h = 1e-3;
    const double slope = per_atom(anchor.a + h) - per_atom(anchor.a - h);
    const double curvature = per_atom(anchor.a + h) - 2 * per_atom(anchor.a) + per_atom(anchor.a - h);
    EXPECT_NEAR(-slope / (2 * curvature) * h, 0, 3e-5);
    const Constants c = constants_of(scene.rule, anchor.a, 5);
    // Differences of tables over 1e-4 of a distance: 0.2 GPa in CuTa, 0.03 in the others.
    EXPECT_NEAR(c.c11, anchor.c11, 0.3);
    EXPECT_NEAR(c.c12, anchor.c12, 0.3);
    EXPECT_NEAR(c.c44, anchor.c44, 0.3);
  }
}

// Of the closed form, at its 18 neighbours: -3.519353 eV at a = 3.615.
TEST(EmbeddedAtoms, CopperOfThisTreeIsAtRest) {
  const Scene scene = metal_scene(kOwnFile, 3.615, 3);
  RoundsRun run(scene, scene.body, {}, 1e-10);
  Asked asked;
  asked.energies = true;
  asked.volume = scene.periodic.extent.prod();
  const Reading reading = run.read(asked);
  EXPECT_NEAR(reading.energies.potential / kEv / static_cast<double>(scene.body.size()), -3.519353, 1e-6);
  EXPECT_LT(reading.stress.norm(), 1e7);  // Pa: 2e-5 of the bulk modulus
  EXPECT_NEAR(run.shown()[0].second[5], -std::sqrt(22.0481) * kEv, 1e-4 * kEv);
}

TEST(EmbeddedAtoms, ForcesAreTheSlopeOfTheEnergy) {
  const Scene scene = metal_scene(kOwnFile, 3.615, 3);
  test::Crystal crystal{scene.body, scene.periodic};
  test::shake(crystal.body, 0.2, 3);
  const std::vector<Vec3> f = make_rounds_engine(scene.rule, crystal.body, crystal.periodic, {})->forces();
  Vec3 sum = Vec3::Zero();
  for (const Vec3& one : f) sum += one;
  constexpr double h = 1e-4;  // angstrom
  const auto moved = [&](size_t i, int axis, double by) {
    test::Crystal other = crystal;
    other.body.x[i][axis] += by * test::kAngstrom;
    return energy_of(scene.rule, other);
  };
  for (const size_t i : {size_t{0}, size_t{17}, size_t{50}})
    for (int axis = 0; axis < 3; ++axis) {
      const double slope = (moved(i, axis, h) - moved(i, axis, -h)) / (2 * h);
      // eV/angstrom; the energy of 108 atoms in doubles, over 2e-4 angstrom.
      EXPECT_NEAR(f[i][axis] / kEv * test::kAngstrom, -slope, 1e-6) << i;
    }
  EXPECT_LT(sum.norm(), 1e-12 * f[0].norm() * static_cast<double>(f.size()));
  EXPECT_GT(f[0].norm() / kEv * test::kAngstrom, 0.1);
}

TEST(EmbeddedAtoms, AnAtomBeyondTheTableIsNamed) {
  const Scene scene = metal_scene(kOwnFile, 3.615, 3);
  // A third of the distance: a density of some thousand, of a table that ends at 100.
  test::Crystal crystal{scene.body, scene.periodic};
  for (Vec3& x : crystal.body.x) x /= 2;
  crystal.periodic.extent.setZero();
  const std::string said = refused_with<std::exception>(
      [&] { make_rounds_engine(scene.rule, crystal.body, crystal.periodic, {}); });
  EXPECT_NE(said.find("the embedding of Cu is asked for at"), std::string::npos) << said;
  EXPECT_NE(said.find("and its table ends at 99.9"), std::string::npos) << said;
  EXPECT_EQ(said.find("particle "), 0u) << said;
}

TEST(EmbeddedAtoms, TheHashBindsTheFile) {
  const auto text_hash = [](const std::string& potential) {
    for (const DeclarationLine& line : metal_scene(potential, 3.615, 3).rule.rounds->settings())
      if (line.name == "text") return line.text;
    return std::string();
  };
  std::ifstream in(kCopper);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const test::Folder folder;
  const std::string same = folder.write("copper", text), hash = text_hash(kOwnFile);
  EXPECT_EQ(text_hash(fmt::format("file = \"{}\"", same)), hash);
  text[text.rfind("e+00") - 1] ^= 1;  // a digit
  EXPECT_NE(text_hash(fmt::format("file = \"{}\"", folder.write("copper", text))), hash);
}

TEST(EmbeddedAtoms, WhatIsWrongIsSaidAtItsPlace) {
  const auto has = [](const std::string& potential, const std::string& what) {
    const std::string said = refused_with<std::exception>([&] { metal_scene(potential, 3.615, 3); });
    EXPECT_NE(said.find(what), std::string::npos) << said;
  };
  has("", "test.toml:4:47: a potential needs its 'file'");
  has(kOwnFile + ", element = \"Ni\"", "has no element 'Ni'");
  has(kOwnFile + ", elements = { firm = \"Cu\" }", "does not say which one the material");
  if (!kPotentialFiles.empty())
    has(fmt::format("file = \"{}/CuTa.eam.alloy\", elements = {{ matter = \"Cu\", other = \"Ta\" }}",
                    kPotentialFiles),
        "'pair' of which element? The potential has several");
  has("file = \"texts/eam.toml\"", "neither a setfl file nor a funcfl file");
  has("file = \"texts/none.eam\"", "none.eam");
  const auto own = [&](const std::string& keys) {
    return refused_with<std::exception>([&] {
      parse_scene(
          "mass = \"63.546 u\"\nbox = { size = \"[2, 2, 2] nm\" }\nparticle = [ { position = \"[1, 1, 1] "
          "nm\" } ]\n"
          "run = { dt = \"2 fs\", steps = 1 }\n[rule]\npotential.file = \"texts/copper.eam.alloy\"\n" +
              keys,
          CUBOCT_SOURCE_DIR "/scenes/rules/test.toml");
    });
  };
  const auto told = [&](const std::string& keys, const std::string& what) {
    const std::string said = own(keys);
    EXPECT_NE(said.find(what), std::string::npos) << said;
  };
  const std::string round = "[[rule.round]]\nsum.force = ";
  told("reach = \"5 angstrom\"\n" + round + "\"slope(pair, r) * d / r\"\n", "beyond the cutoff");
  told("reach = \"cutoff\"\n" + round + "\"slope(pair, r) * d / r\"\n", "accepted");
  told("reach = \"cutoff\"\n" + round + "\"pair(r) * d\"\n", "must be a vector of newtons");
  told("reach = \"cutoff\"\n" + round + "\"slope(pears, r) * d / r\"\n",
       "takes the name of a table's function");
  told("reach = \"cutoff\"\n" + round + "\"density(1) * d\"\n",
       "a length is needed here, not a plain number");
  told("reach = \"cutoff\"\n" + round + "\"density(r, r) * d\"\n", "'density' takes 1 argument, not 2");
}

}  // namespace
}  // namespace cuboct
