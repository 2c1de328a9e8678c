// SPDX-License-Identifier: MIT
// Rules of text for machines: what their rounds read, send and fail with.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include "hw/plan/setup.h"
#include "model/program/integer_program.h"
#include "model/run/integer_run.h"
#include "tests/support/cases.h"
#include "tests/support/dice.h"

namespace cuboct::test {

// A hot packing in a periodic box: in each step some particles leave their cell.
inline std::string hot(const std::string& rule, const std::string& more = "") {
  return "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\" }\nrun = { dt = \"0.2 us\", steps = 9 }\n"
         "[box]\nperiodic = \"xyz\"\ncells = [4, 3, 3]\n[[velocity]]\nthermal_speed = \"300 m/s\"\nseed = "
         "3\n" +
         more + "[rule]\n" + rule;
}

// Of each kind of input and of rounds one: a vector and a number that later rounds read of the other, a field
// that goes on from step to step, one round that reads nothing of the other and so sends nothing, velocities
// and noise.
inline const std::string kFourRounds = R"toml(reach = "1.3 * pitch"
[rule.particle.crowd]
range = [-40, 40]
[rule.particle.way]
kind = "vector"
range = [-40, 40]
[rule.particle.memory]
range = [-1000, 1000]
start = "x.x / pitch"
[[rule.round]]
sum.n = { is = "1 - r / (1.3 * pitch) + noise(7) / 10", when = "r < 1.2 * pitch" }
finish.crowd = "max(min(n, 30), -30)"
[[rule.round]]
sum.w = "(crowd_j - crowd_i) * d / pitch"
finish.way = "[max(min(w.x, 30), -30), max(min(w.y, 30), -30), max(min(w.z, 30), -30)]"
[[rule.round]]
sum.m = "1 - r / (1.3 * pitch)"
finish.memory = "max(min(memory / 2 + m, 900), -900)"
[[rule.round]]
sum.force = "(1 N + 0.1 N * (crowd_i + crowd_j) + 0.01 N * (memory_j + memory_i)) * (r / pitch - 1) * d / r + 0.02 N * (way_j - way_i) - 1e-3 N*s/m * dot(v_i - v_j, d) * d / pitch^2"
)toml";

inline const std::string kOneRound = R"toml(reach = "1.3 * pitch"
[rule.particle.T]
unit = "K"
range = "[0, 2000] K"
start = "300 K + 100 K * x.x / pitch"
[[rule.round]]
sum.heat = "T_j - T_i"
sum.force = "1 kN/m * (r - pitch) * d / r"
finish.T = "T + heat / 30"
)toml";

inline const std::string kTwoRounds = R"toml(reach = "1.3 * pitch"
[rule.particle.crowd]
range = [-40, 40]
[rule.particle.T]
unit = "K"
range = "[0, 2000] K"
start = "300 K + 100 K * x.x / pitch"
[[rule.round]]
sum.n = "1 - r / (1.3 * pitch)"
finish.crowd = "max(min(n, 30), -30)"
[[rule.round]]
sum.heat = "T_j - T_i"
sum.force = "(1 kN/m + 0.1 kN/m * (crowd_i + crowd_j)) * (r - pitch) * d / r"
finish.T = "T + heat / 30"
)toml";

// Velocities move nothing.
inline const std::string kStill = R"toml(reach = "1.3 * pitch"
still = true
[rule.particle.T]
unit = "K"
range = "[0, 2000] K"
resolution = "0.1 K"
start = "300 K + 100 K * x.x / pitch"
[[rule.round]]
sum.heat = "0.03 * (T_j - T_i)"
finish.T = "T + heat"
)toml";

inline Case case_of(const std::string& name, const std::string& text, const Arch& arch, uint64_t steps) {
  Case c;
  c.name = name, c.steps = steps;
  c.scene = parse_scene(text, "rule.toml");
  c.setup.plan = program_plan_of(c.scene, arch, CellForm::cubes);
  const Plan& plan = c.setup.plan;
  c.setup.initial =
      program_beginning(c.scene, {*plan.program, plan.rule, plan.lattice, plan.origin, plan.arch.capacity});
  return c;
}

// Everything that changes cycles alone.
inline Arch drawn(uint64_t seed) {
  Dice dice(seed);
  Arch arch;
  arch.filter_lanes = dice.chance(50) ? dice.draw(1, 4) : dice.draw(5, 64);
  arch.force_pipes = dice.draw(1, std::min(arch.filter_lanes, 4));
  arch.queue_depth = dice.chance(30) ? 1 : dice.draw(2, 30);
  arch.overlap = dice.chance(70);
  arch.link_bits = dice.chance(30) ? 0 : dice.draw(7, 300);
  arch.link_check = dice.chance(60) || arch.link_bits > 200 || arch.link_bits == 0
                        ? LinkCheck::none
                        : static_cast<LinkCheck>(dice.draw(1, 2));
  if (arch.link_check == LinkCheck::none && dice.chance(30)) {
    arch.boards.nodes = {dice.draw(1, 3), dice.draw(1, 2), dice.draw(1, 3)};
    arch.boards.latency = dice.draw(1, 30), arch.boards.interval = dice.draw(1, 4);
  }
  return arch;
}

// `grows`: in step 5 a field leaves its range in the first round's finish, of those to the right. `pushes`:
// in the same step the last round's push is too strong, of all. What is found in an earlier round counts,
// though a lesser id is found later.
inline std::string failing(bool grows, bool pushes) {
  return fmt::format(R"toml(reach = "1.3 * pitch"
[rule.particle.a]
range = [-1, 15]
start = "x.x / pitch"
[rule.particle.b]
range = [-1, 15]
[[rule.round]]
sum.n = "1"
finish.a = "{}"
[[rule.round]]
sum.k = "a_j - a_i"
finish.b = "max(min(k / 1000 + b + {}, 8), 0)"
[[rule.round]]
sum.force = "select(b_i > 5, {} N, 1 N) * (r / pitch - 1) * d / r"
)toml",
                     grows ? "a + 1.9" : "a", pushes ? "0.9" : "0", pushes ? "1e7" : "1");
}

}  // namespace cuboct::test
