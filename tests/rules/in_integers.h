// SPDX-License-Identifier: MIT
// A rule that is text in integers, in cells of its own: for tests.
#pragma once

#include <cmath>
#include <string>

#include "model/base/error.h"
#include "model/contract/quantise.h"
#include "model/program/bond_graph.h"
#include "model/program/integer_program.h"
#include "model/program/program_rule.h"
#include "model/run/integer_run.h"
#include "model/scene/first_step.h"
#include "model/scene/scene.h"
#include "tests/support/refused_with.h"

namespace cuboct {

inline const std::string kIntegerTexts = CUBOCT_SOURCE_DIR "/scenes/rules/";

// A scene's rule in integers, with cells of its reach, and of what its bonds stretch to.
struct InIntegers {
  explicit InIntegers(const std::string& text, int capacity = 16, uint64_t first_step = 0)
      : scene(parse_scene(text, kIntegerTexts + "test.toml")), room(capacity) {
    begin_at_step(scene.rule, first_step);
    const Rule& rule = scene.rule;
    const bool lasting = has_reference_bonds(rule);
    const double edge = rule.cutoff() * (lasting ? 1 + kBondStretch : 1);
    Widths widths;
    widths.position_frac = 28, widths.guard = 10, widths.difference_frac = lasting ? 24 : 23;
    widths.relative_velocity_frac = 30, widths.relative_velocity_bits = 27;
    widths.velocity_bits = widths.sum_bits = widths.displacement_bits = 39;
    fixed = quantise_without_law(rule, edge, widths);
    Vec3 low = Vec3::Constant(INFINITY), high = -low;
    for (const Vec3& x : scene.body.x) low = low.cwiseMin(x), high = high.cwiseMax(x);
    origin = low - Vec3::Constant(1.25 * edge);
    Cell count{};
    for (int a = 0; a < 3; ++a) count[a] = static_cast<int32_t>(std::ceil((high[a] - origin[a]) / edge)) + 1;
    std::vector<Cell> cells;
    for (int32_t z = 0; z < count[2]; ++z)
      for (int32_t y = 0; y < count[1]; ++y)
        for (int32_t x = 0; x < count[0]; ++x) cells.push_back({x, y, z});
    lattice = Lattice(std::move(cells), Cell{});
    program = integer_program(*rule.rounds->text(), fixed, capacity,
                              starts_of(*rule.rounds->text(), rule, scene.body, scene.periodic));
  }
  ProgramSetting setting() const { return {program, fixed, lattice, origin, room}; }
  IntegerRun run() const { return {scene, setting(), program_beginning(scene, setting())}; }
  // From where a run left its body, with what that kept.
  IntegerRun run_from(const Body& body, uint64_t step) const {
    Scene left = scene;
    left.body = body;
    State state = program_beginning(left, setting());
    state.step = step;
    return {scene, setting(), state};
  }

  Scene scene;
  FixedRule fixed;
  Lattice lattice;
  Vec3 origin;
  IntegerProgram program;
  int room;
};

inline std::string small_block(const std::string& run) {
  return "density = \"7.8 g/cm^3\"\n"
         "packing = { pitch = \"1 mm\" }\n"
         "geometry = { shape = \"box\", min = \"[0, 0, 0] mm\", max = \"[6, 3, 3] mm\" }\n" +
         run;
}

inline std::string integer_refusal(const std::string& text) {
  return refused_with([&] { const InIntegers made(text); });
}

}  // namespace cuboct
