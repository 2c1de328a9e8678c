// SPDX-License-Identifier: MIT
// Small bodies whose bonds break, yield, are lost, and migrate with their particles.
#pragma once

#include <random>
#include <stdexcept>
#include <string>

#include "hw/plan/setup.h"
#include "model/program/integer_program.h"
#include "model/run/integer_run.h"
#include "tests/support/cases.h"

namespace cuboct::test {

// What stands behind a rule's text: a block, and its run.
inline std::string block_and_run(const std::string& dt) {
  return R"toml([packing]
pitch = "1 mm"
[geometry]
shape = "box"
min = "[0, 0, 0] mm"
max = "[3.5, 3, 2] mm"
[run]
dt = ")toml" +
         dt + "\"\nsteps = 1\n";
}

inline const std::string kGlass = R"toml(density = "2440 kg/m^3"
[rule]
file = "texts/glass.toml"
parameters = { youngs_modulus = "72 GPa", poissons_ratio = 0.22 }
let.critical_stretch = 0.00091
start.whole = "not ((x_i.y - 1.2 mm) * (x_i.y + d0.y - 1.2 mm) < 0 and x_i.x + d0.x / 2 < 1 mm)"
)toml" + block_and_run("0.04 us");

inline const std::string kPlastic = R"toml(density = "1.41 g/cm^3"
[rule]
file = "texts/plastic.toml"
)toml" + block_and_run("0.2 us");

// Of three rounds, of little arithmetic: springs that break, the weaker the more of their neighbours' bonds
// have broken.
inline const std::string kSprings = R"toml(density = "1.41 g/cm^3"
[rule]
bonds = "reference"
reach = "1.2 * pitch"
stiffness = "8 kN/m"
broken = "not whole"
[rule.bond.whole]
kind = "truth"
start = "true"
[rule.particle.left]
range = [-1, 30]
[rule.particle.near]
range = [-1, 400]
[[rule.round]]
bond.whole = "whole and dot(d, d) < 1.1 * pitch^2"
sum.n = { is = "1", when = "whole" }
finish.left = "n"
[[rule.round]]
sum.all = { is = "left_j", when = "whole" }
finish.near = "min(all, 144)"
[[rule.round]]
sum.force = { is = "(0.5 kN/m + 0.001 kN/m * (near_i + near_j)) * d * (1 - pitch^2 / dot(d, d))", when = "whole" }
)toml" + block_and_run("0.2 us");

struct Motion {
  Vec3 together = Vec3::Zero();  // m/s
  double random = 0;             // m/s, at most, along each axis
  double growth = 0;             // of the body in a step, of its size
  bool flat = false;             // nothing along z
};

struct BondedCase {
  Case c;
  BondedCase(const std::string& text, const Motion& motion, const Arch& arch, uint64_t steps = 8) {
    c.name = "bonds", c.steps = steps;
    c.scene = parse_scene(text, CUBOCT_SOURCE_DIR "/scenes/rules/small.toml");
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> any(-motion.random, motion.random);
    Vec3 middle = Vec3::Zero();
    for (const Vec3& x : c.scene.body.x) middle += x / static_cast<double>(c.scene.body.size());
    c.scene.body.v.clear();
    for (const Vec3& x : c.scene.body.x)
      c.scene.body.v.push_back(motion.together + motion.growth / c.scene.rule.dt * (x - middle) +
                               Vec3(any(random), any(random), any(random)));
    if (motion.flat)
      for (Vec3& v : c.scene.body.v) v.z() = 0;
    c.scene.reach_margin = Vec3::Constant(2e-3);
    const Plan& plan = c.setup.plan = program_plan_of(c.scene, arch, CellForm::cubes);
    c.setup.initial =
        program_beginning(c.scene, {*plan.program, plan.rule, plan.lattice, plan.origin, plan.arch.capacity});
  }
};

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  if (text.find(from) == std::string::npos) throw std::logic_error("no " + from);
  return text.replace(text.find(from), from.size(), to);
}

// Four particles, at the corners of a tetrahedron, with a bond between each two.
inline std::string of_four(const std::string& text) {
  return replaced(text, "[3.5, 3, 2] mm", "[1.1, 1.1, 1.1] mm");
}

}  // namespace cuboct::test
