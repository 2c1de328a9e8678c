// SPDX-License-Identifier: MIT
// Scenes with [rule] kind = "tersoff": crystals, what the engine makes of them, and what is refused where.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "model/analysis/motion.h"
#include "model/atoms/bond_order/atom_motion.h"
#include "model/base/error.h"
#include "model/rules/tersoff_rule.h"
#include "model/run/rounds_run.h"
#include "model/run/static_engine.h"
#include "model/scene/scene.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

constexpr double kEv = kElectronVolt, kA = kAngstrom;

std::string carbon(const std::string& place, const std::string& more = "",
                   const std::string& rule = "potential = \"c_1989\"") {
  return "mass = \"12.011 u\"\n" + place + "[rule]\nkind = \"tersoff\"\n" + rule + "\n" + more +
         "[run]\nsteps = 20\n";
}
const std::string kSheet =
    "crystal = { lattice = \"graphene\" }\nbox = { cells = [6, 4, 1], periodic = \"xy\" }\n";
const std::string kTorn =
    "crystal = { lattice = \"graphene\" }\n"
    "geometry = { shape = \"difference\", from = { shape = \"box\", size = \"[30, 25, 1] angstrom\" }, "
    "minus = [ { shape = \"box\", min = \"[-20, -2, -1] angstrom\", max = \"[0, 2, 1] angstrom\" } ] }\n";
const std::string kDriven =
    "gravity = \"[1e15, 0, 0] m/s^2\"\n"
    "[[constraint]]\nname = \"up\"\nkind = \"moved\"\nvelocity = \"[0, 1200, 0] m/s\"\naxes = \"y\"\n"
    "region = { shape = \"half_space\", point = \"[0, 11, 0] angstrom\", normal = \"-y\" }\n"
    "[[constraint]]\nname = \"down\"\nkind = \"held\"\n"
    "region = { shape = \"half_space\", point = \"[0, -11, 0] angstrom\", normal = \"y\" }\n";

// [constraint] tables stand behind top-level keys.
std::string driven() {
  return kDriven.substr(0, kDriven.find('\n') + 1) + carbon(kTorn, kDriven.substr(kDriven.find('\n') + 1));
}

double potential_of(RoundsRun& run) {
  Asked asked;
  asked.energies = true;
  return run.read(asked).energies.potential;
}

struct KnownCrystal {
  const char* crystal;
  const char* box;
  const char* potential;
  double energy, bond;  // eV and angstrom, by LAMMPS 29 Sep 2021 (tests/bond_order/constants_test.cpp)
};

TEST(TersoffScene, CrystalsAtRestAreThoseOfLammps) {
  const KnownCrystal all[] = {
      {"graphene", "[6, 4, 1], periodic = \"xy\"", "c_1989", -7.393187, 1.460601},
      {"diamond", "[2, 2, 3], periodic = \"xyz\"", "c_1989", -7.368190, 3.565835 * std::sqrt(3) / 4},
      {"diamond", "[2, 2, 2], periodic = \"xyz\"", "si_1989", -4.628873, 5.432115 * std::sqrt(3) / 4}};
  for (const KnownCrystal& known : all) {
    const Scene scene =
        parse_scene(carbon(fmt::format("crystal = {{ lattice = \"{}\" }}\nbox = {{ cells = {} }}\n",
                                       known.crystal, known.box),
                           "", fmt::format("potential = \"{}\"", known.potential)),
                    "s");
    RoundsRun run(scene, scene.body, {}, 1e-9);
    const double atoms = static_cast<double>(scene.body.size());
    EXPECT_NEAR(potential_of(run) / atoms / kEv, known.energy, 1e-6) << known.potential;
    double nearest = 1;
    for (size_t i = 1; i < scene.body.size(); ++i)
      nearest = std::min(nearest, (scene.body.x[i] - scene.body.x[0]).norm());
    EXPECT_NEAR(nearest / kA, known.bond, 1e-6) << known.potential;
    const RealFrame frame = std::get<RealFrame>(run.frame(true));
    for (const Vec3& f : frame.force) EXPECT_LT(f.norm(), 1e-9 * kEv / kA);
    const int neighbours = known.crystal[0] == 'g' ? 3 : 4;
    EXPECT_EQ(run.counters_of_state()[0].second, neighbours * atoms / 2);
  }
}

// Both codes step by velocity Verlet: one in SI units by rounds, the other in eV and angstrom.
TEST(TersoffScene, ADrivenSheetMovesAsAtomMotionMovesIt) {
  const Scene scene = parse_scene(driven(), "s");
  const size_t n = scene.body.size();
  ASSERT_GT(n, 200u);
  RoundsRun run(scene, scene.body, RealOptions{.integrator = Integrator::velocity_verlet}, 1e-9);
  AtomSystem system;
  system.box.edges = 10 * Mat3::Identity();
  const double mass = scene.rule.mass, time = std::sqrt(mass * kA * kA / kEv);  // s, with a mass of 1
  system.mass = {1};
  AtomLoads loads{std::vector<Vec3>(n), std::vector<std::array<bool, 3>>(n),
                  std::vector<Vec3>(n, Vec3::Zero())};
  size_t led = 0;
  for (size_t i = 0; i < n; ++i) {
    const ParticleType& type = scene.rule.types[scene.body.type[i]];
    system.x.push_back(scene.body.x[i] / kA), system.v.push_back(scene.body.v[i] * time / kA);
    loads.force[i] = mass * type.gravity * kA / kEv, loads.imposed[i] = type.imposed;
    loads.velocity[i] = type.velocity * time / kA;
    led += type.imposed[1];
  }
  ASSERT_GT(led, 20u);
  AtomMotion motion(tersoff_set("c_1989"), system, {.dt = scene.rule.dt / time});
  motion.load(loads);
  run.advance(200, nullptr), motion.step(200);
  const RealFrame frame = std::get<RealFrame>(run.frame(true));
  double moved = 0, most = 0;
  for (const Vec3& f : motion.forces()) most = std::max(most, f.norm());
  for (size_t i = 0; i < n; ++i) {
    moved = std::max(moved, (motion.atoms().x[i] - system.x[i]).norm());
    EXPECT_LT((frame.x[i] / kA - motion.atoms().x[i]).norm(), 1e-9) << i;
    EXPECT_LT((frame.force[i] * kA / kEv - motion.forces()[i]).norm(), 1e-9 * most) << i;
  }
  EXPECT_GT(moved, 1);
  EXPECT_NEAR(potential_of(run) / kEv / motion.potential_energy(), 1, 1e-9);
  Asked asked;
  asked.energies = true, asked.volume = 1e-27;  // m^3
  const Mat3 virial = run.read(asked).stress * asked.volume / kEv;
  EXPECT_LT((virial - motion.virial()).norm(), 1e-9 * virial.norm());
}

Body stepped(const Scene& scene, uint64_t steps, int threads) {
  RoundsRun run(scene, scene.body, RealOptions{.threads = threads}, 1e-9);
  run.advance(steps, nullptr);
  return *run.saved_body();
}

TEST(TersoffScene, NoBitDependsOnThreadsOrOnACut) {
  const Scene scene = parse_scene(driven(), "s");
  const Body one = stepped(scene, 60, 1), three = stepped(scene, 60, 3), half = stepped(scene, 35, 1);
  RoundsRun second(scene, half, {}, 1e-9, 35);
  second.advance(25, nullptr);
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one.x[i], three.x[i]) << i;
    EXPECT_EQ(one.x[i], second.saved_body()->x[i]) << i;
  }
}

// Free: momentum to rounding, and the energy of a shaken sheet within a hundredth of what the shaking gave
// it.
TEST(TersoffScene, MomentumAndEnergyAreKept) {
  const Scene scene = parse_scene(carbon(kSheet, "[[velocity]]\ntemperature = \"300 K\"\nseed = 3\n"), "s");
  RoundsRun run(scene, scene.body, RealOptions{.integrator = Integrator::velocity_verlet}, 1e-9);
  Asked asked;
  asked.energies = true;
  const Energies first = run.read(asked).energies;
  run.advance(500, nullptr);
  const Energies last = run.read(asked).energies;
  EXPECT_LT(last.kinetic, 0.8 * first.kinetic);  // half of it is in the bonds
  EXPECT_NEAR(last.total(), first.total(), 0.01 * first.kinetic);
  double most = 0;
  for (const Vec3& v : scene.body.v) most += scene.rule.mass * v.norm();
  EXPECT_LT(run.momentum().real.norm(), 1e-12 * most);
}

// The limit is that of the crystal's fastest vibration: above it a small shake grows, below it does not.
TEST(TersoffScene, TheStableStepIsThatOfTheCrystal) {
  for (const std::string& place :
       {kSheet,
        std::string(
            "crystal = { lattice = \"diamond\" }\nbox = { cells = [2, 2, 2], periodic = \"xyz\" }\n")}) {
    const Scene scene = parse_scene(carbon(place), "s");
    const auto grows = [&](double part) {
      Scene one = scene;
      one.rule.dt = part * scene.dt_limit;
      for (size_t i = 0; i < one.body.size(); ++i)
        one.body.v[i] = 1e-3 * Vec3(std::sin(7.1 * i), std::sin(3.3 * i), std::sin(1.7 * i));
      RoundsRun run(one, one.body, {}, 1e-9);
      run.advance(400, nullptr);
      double fastest = 0;
      for (const Vec3& v : run.saved_body()->v) fastest = std::max(fastest, v.norm());
      return fastest > 1;
    };
    EXPECT_FALSE(grows(0.98));
    EXPECT_TRUE(grows(1.05));
    EXPECT_NEAR(scene.rule.dt, 0.2 * scene.dt_limit, 1e-9 * scene.rule.dt);
  }
}

// Diamond: sqrt((C11 + 2 C12 + 4 C44)/3 density) along [111], with LAMMPS's constants.
TEST(TersoffScene, WavesAreThoseOfTheCrystal) {
  const Scene scene = parse_scene(
      carbon("crystal = { lattice = \"diamond\" }\nbox = { cells = [2, 2, 2], periodic = \"xyz\" }\n"), "s");
  const double density = 8 * scene.rule.mass / std::pow(3.565835e-10, 3);
  EXPECT_NEAR(motion_of(scene).sound_speed,
              std::sqrt((1073.61 + 2 * 101.72 + 4 * 641.27) / 3 * 1e9 / density), 20);
}

// A strip that repeats across the load has the stiffness C11 = 1247.0 GPa times 3.35 angstrom, by LAMMPS. The
// bound is that of LAMMPS's own differences and of the potential's curvature at this strain.
TEST(TersoffScene, StaticLoadingFindsTheModulus) {
  const Scene scene = parse_scene(
      carbon(
          "crystal = { lattice = \"graphene\" }\nbox = { cells = [48, 2, 1], periodic = \"y\" }\n",
          "[[constraint]]\nname = \"right\"\nkind = \"moved\"\nvelocity = \"[120, 0, 0] m/s\"\naxes = \"x\"\n"
          "region = { shape = \"half_space\", point = \"[117, 0, 0] angstrom\", normal = \"-x\" }\n"
          "[[constraint]]\nname = \"left\"\nkind = \"held\"\naxes = \"x\"\n"
          "region = { shape = \"half_space\", point = \"[4, 0, 0] angstrom\", normal = \"x\" }\n") +
          "static = { load_steps = 1, tolerance = 1e-5 }\ndt = \"1 fs\"\n",
      "s");
  StaticEngine engine(scene, scene.body, 1, 1e-9);
  const auto look = [&] {
    const RealFrame frame = std::get<RealFrame>(engine.frame(true));
    double pull = 0, low = 0, high = 0, lows = 0, highs = 0;
    for (size_t i = 0; i < frame.x.size(); ++i) {
      const double at = scene.body.x[i][0] / kA;
      if (at >= 117) pull -= frame.force[i][0];
      if (at > 20 && at < 30) low += frame.x[i][0], ++lows;
      if (at > 90 && at < 100) high += frame.x[i][0], ++highs;
    }
    return std::pair(pull, high / highs - low / lows);
  };
  const auto [pull, length] = look();
  engine.advance(20, nullptr);
  const auto [pulled, longer] = look();
  const double strain = longer / length - 1;
  EXPECT_NEAR(strain, 2.4e-12 / 113e-10, 1e-5);
  EXPECT_NEAR((pulled - pull) / scene.periodic.extent[1] / strain, 1247.0e9 * 3.35e-10, 0.004 * 417.7);
}

std::string carbon_refusal(const std::string& text) {
  return refused_with([&] { parse_scene(text, "s.toml"); });
}

// The set of 1988 in kcal/mol: the energy of silicon is that of the set in eV, -4.630 eV an atom.
TEST(TersoffScene, AFileInRealUnitsIsTheSetInMetalUnits) {
  const test::Folder folder;
  const std::string path =
      folder.write("real.tersoff",
                   "# DATE: 2007-10-25 UNITS: real\n"
                   "Si Si Si 3.0 1.0 1.3258 4.8381 2.0417 0.0 22.956 0.33675 1.3258 2199.35 3.0 0.2 3.2394 "
                   "75286.4\n");
  const auto energy = [](const std::string& rule) {
    const Scene scene = parse_scene(carbon("crystal = { lattice = \"diamond\", bond = \"2.35 angstrom\" "
                                           "}\nbox = { cells = [2, 2, 2], periodic = "
                                           "\"xyz\" }\n",
                                           "", rule),
                                    "s");
    RoundsRun run(scene, scene.body, {}, 1e-9);
    return potential_of(run) / static_cast<double>(scene.body.size()) / kEv;
  };
  const double real = energy("file = \"" + path + "\"\nelement = \"Si\"");
  EXPECT_NEAR(real, -4.630, 5e-4);
  EXPECT_NEAR(real, energy("potential = \"si_1988\""), 1e-4);  // both files round A and B
}

TEST(TersoffScene, WhatCannotBeIsRefusedAtItsKey) {
  const auto has = [](const std::string& text, const std::string& place, const std::string& what) {
    const std::string said = carbon_refusal(text);
    EXPECT_TRUE(said.starts_with(place)) << said;
    EXPECT_NE(said.find(what), std::string::npos) << said;
  };
  const test::Folder folder;
  const std::string path = folder.write(
      "c.tersoff",
      "C C C 3 1 0 38049 4.3484 -0.57058 0.72751 1.5724e-7 2.2119 346.7 1.95 0.15 3.4879 1393.6\n");
  const auto of_file = [&](const std::string& rule) {
    return carbon(kSheet, "", "file = \"" + path + "\"\n" + rule);
  };
  EXPECT_EQ(carbon_refusal(of_file("element = \"C\"")), "accepted");
  has(of_file("element = \"Si\""), "s.toml:7:11", "unknown element 'Si'");
  has(of_file("element = \"C\"\npotential = \"c_1989\""), "s.toml:", "not both");
  has(carbon(kSheet, "", "file = \"nowhere.tersoff\"\nelement = \"C\""), "s.toml:6:8",
      "no file 'nowhere.tersoff'");
  std::ofstream(path)
      << "C C C 3 1 0 38049 -4.3484 -0.57058 0.72751 1.5724e-7 2.2119 346.7 1.95 0.15 3.4879 1393.6\n";
  has(of_file("element = \"C\""), path + ":1:1", "d is -4.3484");
  has(carbon(kSheet, "", "potential = \"c_1998\""), "s.toml:6:13", "did you mean 'c_1989'");
  has(carbon(kSheet, "", "potential = \"c_1989\"\ndamage_width = 1"), "s.toml:7:1",
      "unknown key 'damage_width'");
  has(carbon("crystal = { lattice = \"graphene\" }\nbox = { cells = [1, 4, 1], periodic = \"xy\" }\n"),
      "s.toml:3:17", "2 cells or more along x");
  has(carbon("crystal = { lattice = \"graphene\" }\nbox = { cells = [6, 4, 1], periodic = \"xyz\" }\n"),
      "s.toml:3:39", "graphene does not repeat along z");
  has(carbon("crystal = { lattice = \"diamond\" }\nbox = { size = \"[10, 10, 10] angstrom\", periodic = "
             "\"x\" }\n"),
      "s.toml:3:16", "does not repeat after");
  has(carbon("crystal = { lattice = \"graphite\" }\n"), "s.toml:2:23", "unknown lattice 'graphite'");
  has(carbon("crystal = { lattice = \"graphene\" }\n"), "s.toml:2:11", "nothing says where the crystal ends");
  has(carbon("crystal = { lattice = \"graphene\" }\ngeometry = { shape = \"half_space\", normal = \"x\" }\n"),
      "s.toml:3:12", "no end along");
  has(carbon("packing = { pitch = \"3 angstrom\" }\nbox = { cells = [4, 4, 4] }\n"), "s.toml:5:8",
      "stand in a [crystal]");
  has("mass = \"1 u\"\ncrystal = { lattice = \"diamond\" }\nlaw = { kind = \"elastic\", stiffness = \"1 "
      "N/m\" }\n",
      "s.toml:2:11", "needs [rule]");
  has(carbon(kSheet, "[damping]\ncoefficient = \"1 kg/s\"\n"), "s.toml:", "damping by pairs");
  has(carbon(kSheet,
             "[[probe]]\nname = \"a\"\nkind = \"crack\"\naxis = \"x\"\nregion = { shape = \"sphere\", radius "
             "= \"1 nm\" }\n"),
      "s.toml:9:8", "counts the bonds of a pair law");
}

// The example: whole while its strain is small, then torn from the slit to the other edge.
TEST(TersoffScene, TheExampleTears) {
  const Scene scene = read_scene(std::string(CUBOCT_SOURCE_DIR) + "/scenes/graphene.toml");
  RoundsRun run(scene, scene.body, {}, 1e-9);
  const double whole = run.counters_of_state()[0].second;
  run.advance(scene.steps / 2, nullptr);
  EXPECT_EQ(run.counters_of_state()[0].second, whole);
  run.advance(scene.steps - scene.steps / 2, nullptr);
  EXPECT_LT(run.counters_of_state()[0].second, whole - 15);
}

TEST(TersoffScene, ItsRoundsAreDeclared) {
  const Scene scene = parse_scene(carbon(kSheet), "s");
  const RuleDeclaration& rule = scene.rule.rounds->declaration();
  EXPECT_EQ(rule.bonds, BondRange::current);
  ASSERT_EQ(rule.rounds.size(), 2u);
  EXPECT_EQ(rule.rounds[1].exchanged, std::vector<std::string>{"partial"});
  EXPECT_EQ(numbers_of(rule.particle), 6);
  EXPECT_EQ(numbers_of(rule.particle, true), 3);
  EXPECT_EQ(lines_of(rule)[1].text, "partial (3 a bond), own (3), force (3)");
  EXPECT_EQ(lines_of(rule)[1].note, "6 numbers each, and 3 a bond");
  EXPECT_THROW(refuse_rounds(scene.rule, "the lattice engine"), InputError);
  EXPECT_THROW(RoundsRun(scene, scene.body, RealOptions{.precision = Precision::float32}, 1e-9), InputError);
}

}  // namespace
}  // namespace cuboct
