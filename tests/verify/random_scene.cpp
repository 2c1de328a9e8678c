// SPDX-License-Identifier: MIT
#include "tests/verify/random_scene.h"

#include <algorithm>
#include <cmath>

#include "emu/machine/words.h"
#include "tests/support/dice.h"

namespace cuboct::test {
namespace {

// As many particles as the fullest cell holds at the start.
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
  if (dice.chance(15)) {
    arch.queue_depth = 1;
    if (!arch.narrow_memories) arch.filter_lanes = std::max(arch.filter_lanes, 8);
  }
  if (dice.chance(10)) arch.link_bits = dice.draw(1, 8);
  if (dice.chance(40)) arch.table.shape = TableChoice::Shape::uniform;
  const double speed = dice.chance(30) ? 1 + 0.5 * dice.draw(0, 6) : 1;
  for (Vec3& v : scene.body.v) v *= speed;
  // One trouble in three seeds of four: what each makes likely is in all_faults().
  enum class Trouble { none, w, s, sum, u, v, leave, full, link };
  const Trouble trouble = static_cast<Trouble>(std::max(0, dice.draw(-2, 8)));
  Widths& w = arch.widths;
  const bool damped = scene.rule.damping.coefficient > 0;
  const int more = dice.draw(0, 2);
  if (trouble == Trouble::w && damped) w.relative_velocity_bits -= 2 + more;
  if (trouble == Trouble::s && damped) scene.rule.damping.coefficient *= 40 << more;
  if (trouble == Trouble::sum) w.sum_bits -= 6 + 2 * more;
  if (trouble == Trouble::u) w.displacement_bits -= 4 + 2 * more;
  if (trouble == Trouble::v) w.velocity_bits -= 3 + more;
  if (trouble == Trouble::leave) scene.reach_margin = Vec3::Zero();
  if (trouble == Trouble::leave || trouble == Trouble::full)
    for (Vec3& v : scene.body.v) v *= 1 + more;
  if (trouble == Trouble::link || dice.chance(10)) {
    arch.link_check = dice.chance(50) ? LinkCheck::detect : LinkCheck::retry;
    if (arch.link_bits > 400) arch.link_bits = 400;
  }
  Setup setup = make_setup(scene, arch);
  if (trouble == Trouble::full || dice.chance(10)) {
    arch.capacity = fullest(setup) + dice.draw(0, 1);
    setup = make_setup(scene, arch);
  }
  // Drawn apart, so that the other scenes stay what they were.
  Dice bricks(seed * 0x2545f4914f6cdd1du + 3);
  if (setup.plan.lattice.size() > 1 && !arch.narrow_memories && bricks.chance(35)) {
    const std::vector<Cell> shapes = bricks_for(setup.plan.lattice);
    Cell brick = shapes[static_cast<size_t>(bricks.draw(0, static_cast<int>(shapes.size()) - 1))];
    while (cells_of(brick) > 27) *std::max_element(brick.begin(), brick.end()) -= 1;
    arch.brick = brick;
    setup = make_setup(scene, arch);
  }
  // Apart, too.
  Dice arrivals(seed * 0x9fb21c651e98df25u + 5);
  if (arch.overlap && !arch.narrow_memories && setup.plan.bricks.cells() == 1 && arrivals.chance(40)) {
    arch.halos = Halos::arrival;
    arch.streamers = arch.force_pipes % 2 == 0 && arrivals.chance(60) ? 2 : 1;
    setup = make_setup(scene, arch);
  }
  const LinkCheck check = arch.link_check;
  RandomScene result{{"seed " + std::to_string(seed), std::move(setup), base.steps, std::move(scene)}, {{}}};
  const auto stalled = [&dice] {
    return Judge::Run{.stall_rate = 0.05 * dice.draw(1, 17),
                      .stall_seed = static_cast<uint64_t>(dice.draw(1, 1000000)),
                      .register_seed = static_cast<uint32_t>(dice.draw(1, 1000000))};
  };
  for (int k = 0; k < 2; ++k) result.runs.push_back(stalled());
  if (check == LinkCheck::none) return result;
  result.runs.push_back({.mixed = true});
  for (int k = 0; k < 3; ++k) {
    Judge::Run run = stalled();
    run.stall_rate *= 0.5;
    run.faults.seed = static_cast<uint64_t>(dice.draw(1, 1000000));
    if (check == LinkCheck::retry)
      run.faults.rate = 0.01 * dice.draw(1, 10);
    else
      run.faults.count = 1;
    result.runs.push_back(run);
  }
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
  n["types that only touch"] = rule.contact2 > 0;
  n["masses by type"] = rule.weighted;
  n["several laws"] = rule.law_bits > 0;
  n["several types"] = rule.types.size() > 1;
  n["held or moved"] = any([](const auto& t) { return t.imposed[0] || t.imposed[1] || t.imposed[2]; });
  n["PD"] = rule.pd;
  n["flat"] = rule.axes == 2;
  n["periodic"] = scene.c.scene.periodic.extent.maxCoeff() > 0;
  n["one node"] = plan.nodes() == 1;
  n["bricks"] = plan.bricks.cells() > 1;
  n["octaves"] = rule.force.shape == TableShape::octaves;
  n["degree 2"] = rule.force.degree == 2;
  n["several pipes"] = arch.force_pipes > 1;
  n["several passes"] = arch.filter_lanes < arch.capacity;
  n["no overlap"] = !arch.overlap;
  n["narrow memories"] = arch.narrow_memories;
  n["halos used on arrival"] = arch.halos == Halos::arrival;
  n["two streamers"] = arch.streamers == 2;
  n["several beats per record"] = plan.words.halo_beats > 1;
  n["queue was full"] = counter("queue_stalls") > 0;
  n["cycles with a full queue"] = counter("queue_stalls");
  n["links waited when stalled"] = [&] {
    for (const auto& [key, value] : judge.native(1).trace.counters)
      if (key == "link_waits") return uint64_t{value > 0};
    return uint64_t{0};
  }();
  uint64_t moves = 0, diagonal = 0;
  const auto& states = judge.golden().states;
  for (size_t s = 1; s < states.size(); ++s)
    for (size_t k = 0; k < states[s].particles.size(); ++k) {
      const uint32_t now = states[s].particles[k].cell, before = states[s - 1].particles[k].cell;
      moves += now != before;
      const Cell &to = plan.lattice.cell(now), &from = plan.lattice.cell(before);
      diagonal += (to[0] != from[0]) + (to[1] != from[1]) + (to[2] != from[2]) > 1;
    }
  n["several axes in a step"] = diagonal;
  n["migrations"] = moves;
  n["pairs inside the cutoff"] = counter("pairs_inside");
  uint64_t full = 0;
  for (const auto& step : judge.golden().order)
    for (const auto& node : step) full += static_cast<int>(node.size()) == arch.capacity;
  n["nodes filled to the last slot"] = full;
  n["checked links: detect"] = arch.link_check == LinkCheck::detect;
  n["checked links: retry"] = arch.link_check == LinkCheck::retry;
  n["shared multipliers"] = arch.multipliers == Multipliers::shared;
  n["serial multipliers"] = arch.multipliers == Multipliers::serial;
  for (const Fault fault : {Fault::link_check, Fault::link_order, Fault::link_silent})
    for (size_t k = 0; k < judge.runs(); ++k)
      n[std::string("fault: ") + to_string(fault)] +=
          judge.native(k).trace.stop && judge.native(k).trace.stop->fault == fault;
  for (size_t k = 0; k < judge.runs(); ++k) {
    n["faults on wires"] += judge.native(k).faults.injected();
    n["faults on wires healed"] += judge.native(k).faults.healed;
  }
  for (const Fault fault : all_faults())
    n[std::string("fault: ") + to_string(fault)] =
        judge.golden().fault && judge.native(0).trace.stop && judge.native(0).trace.stop->fault == fault;
  return n;
}

}  // namespace cuboct::test
