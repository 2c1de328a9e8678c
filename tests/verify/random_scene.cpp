// SPDX-License-Identifier: MIT
#include "tests/verify/random_scene.h"

#include <algorithm>
#include <cmath>

#include "emu/systemc/words.h"
#include "tests/support/dice.h"

namespace cuboct::test {
namespace {

// As many particles as the fullest node holds at the start.
int fullest(const Setup& setup) {
  size_t most = 1;
  for (const auto& list : emu::by_node(setup.plan, setup.initial)) most = std::max(most, list.size());
  return static_cast<int>(most);
}

}  // namespace

RandomScene random_scene(uint64_t seed) {
  Dice dice(seed * 0x9e3779b97f4a7c15u + 1);
  const bool flat = dice.chance(30);
  Case base = flat ? random_flat_case(seed) : random_case(seed);
  Scene scene = base.scene;
  Arch arch = base.setup.plan.arch;
  if (dice.chance(15)) arch.queue_depth = 1, arch.filter_lanes = std::max(arch.filter_lanes, 8);
  if (dice.chance(10)) arch.link_bits = dice.draw(1, 8);
  const double speed = dice.chance(30) ? 1 + 0.5 * dice.draw(0, 6) : 1;
  for (Vec3& v : scene.body.v) v *= speed;
  if (dice.chance(25)) {
    Widths& w = arch.widths;
    switch (dice.draw(0, 3)) {
      case 0:
        w.velocity_bits -= dice.draw(0, 3);
        break;
      case 1:
        w.relative_velocity_bits -= dice.draw(1, 4);
        break;
      case 2:
        w.sum_bits -= dice.draw(3, 7);
        break;
      default:
        w.displacement_bits -= dice.draw(1, 6);
    }
  }
  if (dice.chance(15)) scene.reach_margin = Vec3::Zero();  // particles soon leave
  Setup setup = make_setup(scene, arch);
  if (dice.chance(25)) {
    arch.capacity = fullest(setup) + dice.draw(0, 1);
    setup = make_setup(scene, arch);
  }
  RandomScene result{{"seed " + std::to_string(seed), std::move(setup), base.steps, std::move(scene)}, {}, {}};
  result.stalled = {.stall_rate = 0.05 * dice.draw(1, 17),
                    .stall_seed = static_cast<uint64_t>(dice.draw(1, 1000000)),
                    .register_seed = static_cast<uint32_t>(dice.draw(1, 1000000))};
  return result;
}

std::map<std::string, uint64_t> stimuli_of(const RandomScene& scene, const Judge& judge) {
  const Plan& plan = scene.c.setup.plan;
  const FixedRule& rule = plan.rule;
  const Arch& arch = plan.arch;
  std::map<std::string, uint64_t> n;
  const auto any = [&](auto which) {
    return static_cast<uint64_t>(std::any_of(rule.types.begin(), rule.types.end(), which));
  };
  const auto& counters = judge.native(0).trace.counters;
  const auto counter = [&](const std::string& name) {
    for (const auto& [key, value] : counters)
      if (key == name) return static_cast<uint64_t>(value);
    return uint64_t{0};
  };
  n["damped"] = rule.damped;
  n["strengths by type"] = rule.type_bits > 0 && plan.rule.scaled;
  n["several types"] = rule.types.size() > 1;
  n["held or moved"] = any([](const auto& t) { return t.imposed[0] || t.imposed[1] || t.imposed[2]; });
  n["PD"] = rule.pd;
  n["flat"] = rule.axes == 2;
  n["periodic"] = scene.c.scene.periodic.extent.maxCoeff() > 0;
  n["one node"] = plan.lattice.size() == 1;
  n["octaves"] = rule.force.shape == TableShape::octaves;
  n["degree 2"] = rule.force.degree == 2;
  n["several pipes"] = arch.force_pipes > 1;
  n["several passes"] = arch.filter_lanes < arch.capacity;
  n["no overlap"] = !arch.overlap;
  n["several beats per record"] = plan.words.halo_beats > 1;
  n["queue was full"] = counter("queue_stalls") > 0;
  n["cycles with a full queue"] = counter("queue_stalls");
  n["links waited when stalled"] = [&] {
    for (const auto& [key, value] : judge.native(1).trace.counters)
      if (key == "link_waits") return uint64_t{value > 0};
    return uint64_t{0};
  }();
  uint64_t moves = 0;
  const auto& states = judge.golden().states;
  for (size_t s = 1; s < states.size(); ++s)
    for (size_t k = 0; k < states[s].particles.size(); ++k)
      moves += states[s].particles[k].node != states[s - 1].particles[k].node;
  n["migrations"] = moves;
  n["pairs inside the cutoff"] = counter("pairs_inside");
  uint64_t full = 0;
  for (const auto& step : judge.golden().order)
    for (const auto& node : step) full += static_cast<int>(node.size()) == arch.capacity;
  n["nodes filled to the last slot"] = full;
  for (const Fault fault : all_faults())
    n[std::string("fault: ") + to_string(fault)] =
        judge.golden().fault && judge.native(0).trace.stop && judge.native(0).trace.stop->fault == fault;
  return n;
}

}  // namespace cuboct::test
