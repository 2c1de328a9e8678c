// SPDX-License-Identifier: MIT
#include "tests/support/cases.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>

#include "model/contract/golden.h"
#include "tests/support/dice.h"
#include "tests/support/recipe.h"

namespace cuboct::test {
namespace {

// One feature or awkward size each: what makes it of the usual block.
const std::map<std::string, const char*>& recipes() {
  static const std::map<std::string, const char*> all{
      {"undamped_2x2x2", "margin=0 steps=15"},
      {"lattice_3x2x1", "size=3x2x1 margin=0 steps=15"},
      {"single_node", "size=1x1x1 margin=0.1 cell_edge=12 steps=40"},
      {"damped", "damping=0.2"},
      {"two_materials", "two_materials"},
      {"contact", "two_materials contact damping=0.2 speed=0.3"},
      {"masses", "two_materials masses speed=0.3"},
      {"laws", "two_materials laws damping=0.2 speed=0.3"},
      {"held_and_moved", "held"},
      {"force_held", "force_held gravity"},
      {"octaves", "octaves"},
      {"degree_2", "degree=2 index_bits=6"},
      {"two_pipes", "pipes=2"},
      {"several_passes", "lanes=2"},
      {"one_lane", "lanes=1"},
      {"narrow_links", "link_bits=17"},
      {"wide_links", "link_bits=1000"},
      {"no_overlap", "no_overlap"},
      {"queue_of_one", "queue=1"},
      {"tight_capacity", "capacity=6 margin=0 steps=15"},
      {"ring_of_3", "size=4x1x1 periodic=1x0x0"},
      {"periodic_27", "size=4x4x4 periodic=1x1x1 capacity=20 steps=8"},
      {"hot_gas", "jitter=0.1 speed=0.6 margin=4 steps=40"},
      {"lone_diagonal", "lone margin=2"},
      // Halos used on arrival: several passes, several beats, checked links, rings, crowded queues.
      {"arrival_one", "jitter=0.1 speed=0.6 margin=4 steps=40 arrival lanes=4 pipes=3 queue=2"},
      {"arrival_two",
       "speed=0.4 margin=2 steps=20 damping=0.2 two_materials masses held arrival streamers=2 pipes=2 "
       "lanes=5 "
       "link_bits=40 degree=2 index_bits=7"},
      {"arrival_ring",
       "size=4x4x4 speed=0.4 periodic=1x1x1 arrival streamers=2 pipes=4 capacity=20 retry steps=8"},
      {"flat_arrival", "flat size=4x3x1 speed=0.5 margin=3 arrival streamers=2 pipes=2 link_bits=23 queue=1"},
      {"flat_arrival_shared", "flat force_held size=3x3x1 arrival shared"},
      // Flat ones: no third axis.
      {"flat", "flat size=3x3x1"},
      {"flat_gas", "flat size=4x4x1 jitter=0.1 speed=0.6 margin=4 steps=40"},
      {"flat_ring", "flat size=4x4x1 periodic=1x1x0 no_overlap link_bits=19 lanes=2"},
      {"flat_rich_damped",
       "flat size=4x3x1 damping=0.2 speed=0.5 two_materials contact masses held pipes=2 lanes=3 capacity=13 "
       "queue=1"},
      {"flat_rich_force_held",
       "flat size=3x3x1 force_held octaves degree=2 index_bits=7 link_bits=24 no_overlap"},
      {"flat_shared", "flat size=3x3x1 damping=0.2 shared queue=2"},
      {"flat_narrow",
       "flat size=4x3x1 speed=0.5 margin=3 link_bits=11 shared octaves degree=2 index_bits=7 narrow"},
      // Several cells a node, whose pairs wait for multipliers.
      {"brick_serial",
       "damping=0.2 speed=0.5 two_materials masses held serial pipes=2 queue=2 brick=2x1x2 steps=12"},
      {"brick_shared", "flat size=4x3x1 damping=0.2 speed=0.5 margin=3 shared lanes=3 queue=1 brick=2x2x1"},
      // Rich ones, of which the RTL is built. In the first the sign of x lies in two words.
      {"rich_narrow", "damping=0.2 speed=0.5 two_materials masses laws held serial link_bits=21 narrow"},
      {"rich_shared",
       "damping=0.2 speed=0.3 two_materials contact laws held shared filter_frac=5 lanes=3 queue=2 "
       "link_bits=40"},
      {"rich_damped", "damping=0.2 speed=0.5 two_materials contact masses held pipes=2 lanes=4 capacity=13"},
      {"rich_force_held",
       "force_held gravity two_materials masses octaves degree=2 index_bits=7 link_bits=24 no_overlap"},
      {"rich_ring",
       "size=4x1x2 two_materials laws periodic=1x0x0 queue=1 lanes=3 pipes=3 uniform degree=2 index_bits=6"},
  };
  return all;
}

Recipe usual() {
  Recipe r;
  r.features = {.size = {2, 2, 2}, .jitter = 0.08, .speed = 0.2, .margin = 1.0};
  r.steps = 30;
  return r;
}

Case cook(const std::string& name, const Recipe& recipe) {
  Scene scene = block_scene(recipe.features);
  scene.steps = recipe.steps;
  for (int a = 0; a < 3; ++a)
    if (recipe.periodic[a] != 0) {
      scene.periodic.origin[a] = -0.3;
      scene.periodic.extent[a] = recipe.features.size[a] * std::sqrt(2.0);
    }
  if (recipe.lone) {
    scene.body.x[0] = Vec3::Constant(-4);
    scene.body.v[0] = Vec3::Constant(1);
  }
  return {name, make_setup(scene, recipe.arch), recipe.steps, scene};
}

// Puts hand-made particles into a scene of the block's rule; far ones along `side` fill up to five, so that
// all such plans have the same words.
Setup with_particles(Scene& scene, const Arch& arch, std::vector<Vec3> x, std::vector<Vec3> v, int side = 1) {
  while (x.size() < 5) {
    x.push_back(Vec3::Unit(side) * (6.0 + 3.0 * static_cast<double>(x.size())));
    v.push_back(Vec3::Zero());
  }
  scene.body = {};
  scene.body.x = x;
  scene.body.v = v;
  scene.body.type.assign(x.size(), 0);
  return make_setup(scene, arch);
}

}  // namespace

std::vector<std::string> case_names() {
  std::vector<std::string> names;
  for (const auto& [name, words] : recipes()) names.push_back(name);
  return names;
}

Case make_case(const std::string& name) {
  if (const size_t at = name.find(".brick_"); at != std::string::npos) {
    Cell brick;
    if (std::sscanf(name.c_str() + at, ".brick_%dx%dx%d", &brick[0], &brick[1], &brick[2]) != 3)
      throw std::invalid_argument(name);
    Case c = with_brick(make_case(name.substr(0, at)), brick);
    c.name = name;
    return c;
  }
  Recipe recipe = usual();
  const size_t dot = name.find('.');
  season(recipe, recipes().at(name.substr(0, dot)));
  const std::string variant = dot == std::string::npos ? "" : name.substr(dot);
  if (variant == ".snug") recipe.features.margin = 0;
  if (variant == ".retry") recipe.arch.link_check = LinkCheck::retry;
  if (variant == ".detect") recipe.arch.link_check = LinkCheck::detect;
  return cook(name, recipe);
}

Case random_recipe(uint64_t seed, bool flat) {
  Dice dice(seed);
  Recipe r = usual();
  r.features.flat = flat;
  r.features.seed = seed;
  r.features.size = {dice.draw(1, 3), dice.draw(1, 3), dice.draw(1, 2)};
  r.features.jitter = 0.01 * dice.draw(0, 10);
  r.features.speed = 0.01 * dice.draw(0, 60);
  r.features.damping = dice.chance(40) ? 0.05 * dice.draw(1, 4) : 0;
  r.features.two_materials = dice.chance(40);
  // Drawn apart, so that the other scenes stay what they were.
  r.features.contact = Dice(seed * 0x9e3779b97f4a7c15u + 5).chance(40);
  r.features.masses = Dice(seed * 0x9e3779b97f4a7c15u + 7).chance(40);
  r.features.laws = Dice(seed * 0x9e3779b97f4a7c15u + 11).chance(40);
  r.features.held = dice.chance(25);
  r.features.force_held = !r.features.held && dice.chance(30);
  r.features.gravity = dice.chance(30);
  r.features.margin = 0.5 * dice.draw(0, 6);
  r.arch.filter_lanes = dice.draw(1, 12);
  r.arch.force_pipes = dice.draw(1, std::min(3, r.arch.filter_lanes));
  r.arch.queue_depth = dice.chance(50) ? dice.draw(1, 3) : 16;
  r.arch.overlap = dice.chance(60);
  r.arch.link_bits = dice.chance(50) ? 0 : dice.draw(5, 150);
  r.arch.table.degree = dice.draw(1, 2);
  r.arch.table.index_bits = r.arch.table.degree == 2 ? 7 : 9;
  if (dice.chance(30)) r.arch.table.shape = TableChoice::Shape::octaves;
  r.arch.cell_edge = dice.chance(30) ? 2.0 + 0.1 * dice.draw(0, 10) : 0;
  r.arch.capacity = r.arch.cell_edge > 0 ? 40 : dice.draw(14, 24);
  r.steps = static_cast<uint64_t>(dice.draw(5, 12));
  if (dice.chance(25)) {
    r.features.size[1] = 4;
    r.periodic = {0, 1, 0};
    r.arch.cell_edge = 0;
    r.arch.capacity = 24;
  }
  if (dice.chance(30)) r.arch.multipliers = dice.chance(60) ? Multipliers::shared : Multipliers::serial;
  if (dice.chance(30)) r.arch.widths.filter_frac = dice.draw(2, 14);
  if (dice.chance(20)) narrow(r.arch);
  return cook((flat ? "random_flat_" : "random_") + std::to_string(seed), r);
}

Case random_case(uint64_t seed) { return random_recipe(seed, false); }

Case uneven_case(uint64_t seed) {
  Dice dice(seed);
  Features f;
  f.seed = seed;
  f.size = {5, 4, 6};
  std::rotate(f.size.begin(), f.size.begin() + dice.draw(0, 2), f.size.end());
  f.jitter = 0.01 * dice.draw(0, 8);
  f.speed = 0.02 * dice.draw(0, 20);
  f.damping = dice.chance(50) ? 0.05 * dice.draw(1, 4) : 0;
  f.two_materials = dice.chance(60);
  f.contact = dice.chance(40), f.masses = dice.chance(40), f.laws = dice.chance(40);
  f.force_held = dice.chance(30);
  Scene scene = block_scene(f);
  for (int a = 0; a < 3; ++a) {
    scene.periodic.origin[a] = -0.3;
    scene.periodic.extent[a] = f.size[static_cast<size_t>(a)] * std::sqrt(2.0);
  }
  Arch arch;
  arch.capacity = 60;
  arch.table.degree = dice.draw(1, 2);
  if (!f.masses && dice.chance(40)) arch.widths.difference_frac = 24, arch.widths.position_frac = 28;
  Plan plan = plan_of(scene, arch, CellForm::any);
  State initial = to_fixed(scene.body, plan.rule, plan.lattice, plan.origin);
  return {"uneven_" + std::to_string(seed), {std::move(plan), std::move(initial)}, 20, std::move(scene)};
}

Case random_flat_case(uint64_t seed) { return random_recipe(seed, true); }

Case with_narrow_memories(Case c) {
  Plan& plan = c.setup.plan;
  Arch arch = plan.arch;
  narrow(arch);
  plan = make_plan(plan.rule, arch, plan.lattice, plan.origin, plan.particles);
  return c;
}

Case with_halos_on_arrival(Case c) {
  Plan& plan = c.setup.plan;
  Arch arch = plan.arch;
  arch.brick = {1, 1, 1};
  arch.narrow_memories = false;
  arch.overlap = true;
  arch.halos = Halos::arrival;
  arch.streamers = arch.force_pipes = std::min(arch.filter_lanes, 2);
  plan = make_plan(plan.rule, arch, plan.lattice, plan.origin, plan.particles);
  return c;
}

Case with_boards(Case c, const DeviceCut& boards) {
  Plan& plan = c.setup.plan;
  Arch arch = plan.arch;
  arch.boards = boards;
  arch.link_check = LinkCheck::none;
  plan = make_plan(plan.rule, arch, plan.lattice, plan.origin, plan.particles);
  return c;
}

Case with_brick(Case c, const Cell& brick) {
  Plan& plan = c.setup.plan;
  Arch arch = plan.arch;
  arch.brick = brick;
  arch.narrow_memories = false;
  if (cells_of(brick) > 1) arch.halos = Halos::phases, arch.streamers = 1;
  plan = make_plan(plan.rule, arch, plan.lattice, plan.origin, plan.particles);
  return c;
}

namespace {

Cell length_of(const Lattice& lattice) {
  Cell low = lattice.cell(0), high = low, length;
  for (uint32_t n = 1; n < lattice.size(); ++n)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], lattice.cell(n)[a]);
      high[a] = std::max(high[a], lattice.cell(n)[a]);
    }
  for (int a = 0; a < 3; ++a)
    length[a] = lattice.period()[a] > 0 ? lattice.period()[a] : high[a] - low[a] + 1;
  return length;
}

}  // namespace

namespace {

// The same on a lattice of only those cells that hold a particle at some step, and those on the ways.
Case hollowed(Case c) {
  Plan& plan = c.setup.plan;
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  std::vector<bool> held(plan.lattice.size());
  const auto note = [&] {
    for (uint32_t n = 0; n < held.size(); ++n) held[n] = held[n] || !golden.cells()[n].empty();
  };
  note();
  for (uint64_t step = 0; step < c.steps; ++step) golden.step(), note();
  std::vector<Cell> cells;
  for (uint32_t n = 0; n < held.size(); ++n)
    if (held[n]) cells.push_back(plan.lattice.cell(n));
  Lattice lattice(cells, plan.lattice.period());
  for (Particle& p : c.setup.initial.particles) p.cell = lattice.find(plan.lattice.cell(p.cell));
  plan = make_plan(plan.rule, plan.arch, std::move(lattice), plan.origin, plan.particles);
  return c;
}

}  // namespace

Case lumps(const Vec3& apart) {
  Scene scene = block_scene({.size = {4, 2, 2}, .jitter = 0.08, .speed = 0.4, .margin = 4.0});
  scene.steps = 10;
  const double edge = make_setup(scene, Arch{}).plan.rule.cell_edge;
  double low = INFINITY, high = -INFINITY;
  for (const Vec3& x : scene.body.x) low = std::min(low, x[0]), high = std::max(high, x[0]);
  const double middle = 0.5 * (low + high);
  for (Vec3& x : scene.body.x)
    if (x[0] > middle) x += edge * apart;
  return hollowed({"lumps", make_setup(scene, Arch{}), scene.steps, scene});
}

std::vector<Cell> bricks_for(const Lattice& lattice) {
  const Cell length = length_of(lattice);
  std::vector<Cell> bricks{length};
  for (const Cell& shape : {Cell{2, 2, 2}, Cell{3, 3, 3}, Cell{1, 2, 3}, Cell{4, 1, 2}, Cell{2, 4, 1}}) {
    Cell brick;
    for (int a = 0; a < 3; ++a) brick[a] = std::min(shape[a], length[a]);
    if (std::find(bricks.begin(), bricks.end(), brick) == bricks.end()) bricks.push_back(brick);
  }
  std::erase_if(bricks, [](const Cell& b) { return cells_of(b) == 1 || cells_of(b) > kMostBrickCells; });
  return bricks;
}

Case random_brick_case(uint64_t seed) {
  Case c = seed % 4 == 0 ? random_flat_case(seed) : random_case(seed);
  Dice dice(seed * 31 + 7);
  const Cell length = length_of(c.setup.plan.lattice);
  Cell brick{1, 1, 1};
  for (int a = 0; a < 3; ++a) brick[a] = dice.draw(1, std::min(length[a], 5));
  if (cells_of(brick) == 1) brick = bricks_for(c.setup.plan.lattice).front();
  return with_brick(std::move(c), brick);
}

std::vector<Fault> all_faults() {
  return {Fault::relative_velocity,
          Fault::strength,
          Fault::sum,
          Fault::displacement,
          Fault::velocity,
          Fault::left_x,
          Fault::full_x,
          Fault::left_y,
          Fault::full_y,
          Fault::left_z,
          Fault::full_z};
}

Case fault_case(Fault fault) {
  Case result{to_string(fault), {}, 30};
  const int code = static_cast<int>(fault);
  if (fault >= Fault::left_x) {
    // Four particles in a cell and one that flies in along an axis, or out of the lattice. All share one rule
    // and arch.
    const int axis = (code - static_cast<int>(Fault::left_x)) / 2;
    const bool full = (code - static_cast<int>(Fault::left_x)) % 2 == 1;
    Scene scene = block_scene({.jitter = 0, .speed = 0, .margin = full ? 3.0 : 0.0});
    scene.steps = result.steps;
    Arch arch;
    arch.capacity = 4;
    std::vector<Vec3> x{{0, 0, 0}, {0, 0.70711, 0.70711}, {0.70711, 0, 0.70711}, {0.70711, 0.70711, 0}};
    std::vector<Vec3> v(4, Vec3::Zero());
    Vec3 at = Vec3::Constant(0.3), speed = Vec3::Zero();
    at[axis] = full ? -1.5 : 1.1;
    speed[axis] = full ? 0.8 : 1.5;
    if (!full) {  // alone, so that the others do not push it aside
      x.resize(1);
      v.resize(1);
    }
    x.push_back(at);
    v.push_back(speed);
    result.setup = with_particles(scene, arch, x, v, (axis + 1) % 3);
    result.scene = scene;
    return result;
  }
  // One rule with damping and PD and narrow formats; what differs is where the particles are and how fast.
  Scene scene = block_scene({.size = {1, 1, 1}, .damping = 40, .force_held = true, .margin = 3});
  scene.steps = result.steps;
  Arch arch;
  arch.widths.velocity_bits = 27;
  arch.widths.relative_velocity_bits = 17;
  arch.widths.sum_bits = 24;
  arch.widths.displacement_bits = 28;
  const double out = 1.25;
  switch (fault) {
    case Fault::relative_velocity:
      result.setup = with_particles(scene, arch, {{0, 0, 0}, {out, 0, 0}}, {{0.5, 0, 0}, {-0.5, 0, 0}});
      break;
    case Fault::strength:
      result.setup = with_particles(scene, arch, {{0, 0, 0}, {0.5, 0, 0}}, {{0.3, 0, 0}, {-0.3, 0, 0}});
      break;
    case Fault::sum:
      result.setup = with_particles(scene, arch, {{0, 0, 0}, {0.5, 0.1, 0}, {0.4, -0.2, 0.1}},
                                    {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
      break;
    case Fault::displacement:
      result.setup = with_particles(scene, arch, {{0, 0, 0}, {3, 0, 0}}, {{1.7, 0, 0}, {0, 0, 0}});
      break;
    case Fault::velocity:
      result.setup = with_particles(scene, arch, {{0, 0, 0}, {0, 0.5, 0}}, {{0, 2.65, 0}, {0, 2.65, 0}});
      break;
    default:
      throw std::logic_error("no such fault");
  }
  result.scene = scene;
  return result;
}

}  // namespace cuboct::test
