// SPDX-License-Identifier: MIT
// Crystals of embedded atoms, and the rule of scenes/rules/texts/eam.toml with a file's tables.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <string>

#include "model/real/real_engine.h"
#include "model/real/rounds_engine.h"
#include "model/rules/rounds_rule.h"
#include "model/scene/scene.h"

namespace cuboct::test {

inline constexpr double kEv = 1.602176634e-19, kAngstrom = 1e-10;

// `potential`: keys of [rule] potential; a: angstrom. A box of `cells`^3 cells at rest.
inline Scene metal_scene(const std::string& potential, double a, int cells, const std::string& more = {}) {
  return parse_scene(fmt::format("mass = \"63.546 u\"\npacking = {{ pitch = \"{:.12g} angstrom\" }}\n"
                                 "box = {{ periodic = \"xyz\", cells = [{}, {}, {}] }}\n"
                                 "rule = {{ file = \"texts/eam.toml\", potential = {{ {} }} }}\nrun = {{ dt "
                                 "= \"2 fs\", steps = 10 }}\n",
                                 a / std::sqrt(2.0), cells, cells, cells, potential) +
                         more,
                     CUBOCT_SOURCE_DIR "/scenes/rules/test.toml");
}

struct Crystal {
  Body body;
  Periodic periodic;
};

// FCC with axes along [100], or along [110], [-110] and [001].
inline Crystal fcc_crystal(double a, int cells, bool turned, const Vec3& stretch = Vec3::Ones()) {
  Crystal of;
  const Vec3 edge = turned ? Vec3(a / std::sqrt(2.0), a / std::sqrt(2.0), a) : Vec3(a, a, a);
  const std::vector<Vec3> basis = turned
                                      ? std::vector<Vec3>{{0, 0, 0}, {.5, .5, .5}}
                                      : std::vector<Vec3>{{0, 0, 0}, {0, .5, .5}, {.5, 0, .5}, {.5, .5, 0}};
  const int wide = turned ? static_cast<int>(std::ceil(cells * std::sqrt(2.0))) : cells;
  for (int i = 0; i < wide; ++i)
    for (int j = 0; j < wide; ++j)
      for (int k = 0; k < cells; ++k)
        for (const Vec3& b : basis)
          of.body.x.push_back((Vec3(i, j, k) + b).cwiseProduct(edge).cwiseProduct(stretch) * kAngstrom);
  of.periodic.extent =
      Vec3(wide * edge[0], wide * edge[1], cells * edge[2]).cwiseProduct(stretch) * kAngstrom;
  of.body.v.assign(of.body.x.size(), Vec3::Zero());
  of.body.type.assign(of.body.x.size(), 0);
  return of;
}

// eV
inline double energy_of(const Rule& rule, const Crystal& crystal) {
  return make_rounds_engine(rule, crystal.body, crystal.periodic, {})->terms()->energy() / kEv;
}

inline void shake(Body& body, double most, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> move(-most * kAngstrom, most * kAngstrom);
  for (Vec3& x : body.x) x += Vec3(move(random), move(random), move(random));
}

}  // namespace cuboct::test
