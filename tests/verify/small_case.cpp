// SPDX-License-Identifier: MIT
#include "tests/verify/small_case.h"

#include <functional>
#include <map>

#include "tests/support/block.h"

namespace cuboct::test {
namespace {

struct Small {
  Features features{.size = {2, 1, 1}, .cutoff = 1.4, .jitter = 0.05, .speed = 0.3, .margin = 0};
  Arch arch;
  uint64_t steps = 6;
  std::function<void(Scene&)> change{};  // the scene, before it is quantised
  std::function<void(Setup&)> place{};   // where particles start
};

Arch small_arch() {
  Arch arch;
  arch.capacity = 7;
  arch.filter_lanes = 2;
  arch.queue_depth = 2;
  arch.link_bits = 13;
  Widths& w = arch.widths;
  w.position_frac = 12, w.guard = 4, w.difference_frac = 9;
  w.velocity_bits = 17, w.relative_velocity_frac = 12, w.relative_velocity_bits = 12;
  w.strength_bits = 12, w.sum_bits = 17, w.displacement_bits = 18;
  w.scale_frac = 8;
  arch.table = {.shape = TableChoice::Shape::uniform, .degree = 1, .index_bits = 5};
  return arch;
}

// A particle of the neighbour node in each direction gets the offset of one of node 0: where the cell's edge
// is the cutoff, r2 of the two is cutoff2, at which nothing acts, and each size of the planar test is its
// bound.
void at_the_cutoff(Setup& setup) {
  auto& particles = setup.initial.particles;
  const auto first_of = [&](uint32_t node) -> Particle& {
    for (Particle& p : particles)
      if (p.cell == node) return p;
    throw std::logic_error("a node of the case is empty");
  };
  const Particle from = first_of(0);
  for (const int face : {1, 3, 5})
    if (const uint32_t other = setup.plan.lattice.neighbour(0, face); other != kNoCell)
      first_of(other).x = from.x;
}

// One particle of the first node goes to the last node, and one the other way, over all three axes in one
// step.
void cross_the_corner(Setup& setup) {
  const int64_t edge = int64_t{1} << setup.plan.rule.widths.velocity_frac();
  const int64_t most = (int64_t{1} << (setup.plan.rule.widths.velocity_bits - 4)) - 1;
  const uint32_t last = setup.plan.lattice.size() - 1;
  bool up = false, down = false;
  for (Particle& q : setup.initial.particles) {
    if (q.cell == 0 && !up) {
      up = true;
      q.x = {edge - 9, edge - 7, edge - 5};
      q.v = {most, most - 77, most / 2};
    } else if (q.cell == last && !down) {
      down = true;
      q.x = {3, 5, 8};
      q.v = {-most, 55 - most, -most / 2};
    }
  }
}

// All of the last cell go to the one below it along x, in the first step.
void pour_down(Setup& setup) {
  const int64_t most = (int64_t{1} << (setup.plan.rule.widths.velocity_bits - 4)) - 1;
  for (Particle& q : setup.initial.particles)
    if (q.cell == setup.plan.lattice.size() - 1) q.x[0] = 3 + q.id, q.v[0] = -most;
}

// Half of the particles drift up, half down, all the time: inboxes go round.
void drift(Scene& scene) {
  for (size_t k = 0; k < scene.body.size(); ++k) scene.body.v[k] += (k % 2 == 0 ? 1 : -1) * Vec3(1.6, 1.1, 0);
  for (int a = 0; a < 2; ++a) {
    scene.periodic.origin[a] = -0.3;
    scene.periodic.extent[a] = 4 * std::sqrt(2.0);
  }
}

// Two alone in a ring of three cells along each axis, one along a diagonal through the cells' corners, up,
// one down: cells, and nodes, become empty, and an empty one gets a particle that goes on along the next
// axis.
void fly(Scene& scene) {
  Body body;
  const double edge = std::sqrt(2.0);
  for (int k = 0; k < 2; ++k) {
    body.x.push_back(Vec3(0.5 + k * edge, 0.5, 0.5));
    body.v.push_back((k == 0 ? 1 : -1) * Vec3(1.7, 1.7, 1.7));
    body.type.push_back(0);
  }
  scene.body = body;
  for (int a = 0; a < 3; ++a) scene.periodic.origin[a] = 0, scene.periodic.extent[a] = 3 * edge;
  scene.reach_margin = Vec3::Constant(3 * edge);
}

// A particle of node 0 a few places of the position beside another, below a table's first octave, and one at
// 0.3 of the cell's edge, where r2 has fewer bits than the table's address.
void close_together(Setup& setup) {
  Particle* first = nullptr;
  int moved = 0;
  const Widths& w = setup.plan.rule.widths;
  const int64_t edge = int64_t{1} << w.velocity_frac();
  for (Particle& p : setup.initial.particles) {
    if (p.cell != 0 || moved == 2) continue;
    if (first == nullptr) {
      first = &p;
      continue;
    }
    const int64_t d = moved++ == 0 ? int64_t{3} << w.guard : 3 * edge / 10;
    p.x = first->x;
    p.x[0] += p.x[0] > edge / 2 ? -d : d;
  }
}

// Two particles alone, one above the other: the candidate that acts is the last one of a step.
void one_pair(Scene& scene) {
  Body body;
  for (const double z : {0.5, 1.6}) {
    body.x.emplace_back(0.5, 0.5, z);
    body.v.emplace_back(0.01, -0.02, 0.03);
    body.type.push_back(0);
  }
  scene.body = body;
}

// Velocities by turns +v, -v, so that pairs meet; less on the later axes, and a little different for each
// particle. Nothing before the axis `first`.
void set_velocities(Setup& setup, int64_t v, bool by_turns, int first = 0) {
  for (Particle& p : setup.initial.particles)
    for (int a = first; a < 3; ++a)
      p.v[a] = (by_turns && (p.id + static_cast<uint32_t>(a)) % 2 == 0 ? -1 : 1) *
               (v - 200 * a - 7 * int64_t{p.id});
}

// One rule and machine with damping and PD, of which every number is near its limit; what a scene sets is
// what it makes fail, of several particles, pairs and axes in one step.
void failing(Small& s) {
  s.features.damping = 8;
  s.features.force_held = true;
  s.features.speed = 0;
  s.arch.force_pipes = 2;
  s.arch.widths.sum_bits = 11;
  s.steps = 3;
}

// Memories of words of a beat. With the 13 bits of small_arch the sign of x lies in two words, that of y in
// one.
void narrow(Arch& arch) {
  arch.narrow_memories = true;
  arch.filter_lanes = arch.force_pipes = 1;
  arch.overlap = false;
}

// Another case's scene and machine in nodes of several cells.
const std::map<std::string, std::pair<const char*, Cell>>& bricks() {
  static const std::map<std::string, std::pair<const char*, Cell>> all{
      {"brick_hot", {"hot", {2, 2, 1}}},           {"brick_thin", {"hot", {1, 2, 1}}},
      {"brick_whole", {"hot", {2, 2, 2}}},         {"brick_drift", {"drift", {2, 3, 1}}},
      {"brick_full", {"full", {2, 1, 1}}},         {"brick_pd", {"pd", {2, 1, 1}}},
      {"brick_edge", {"edge", {2, 1, 2}}},         {"brick_pour", {"pour", {2, 1, 1}}},
      {"brick_retry", {"retry", {2, 1, 1}}},       {"brick_fails_sum", {"fails_sum", {2, 1, 1}}},
      {"brick_fails_v", {"fails_v", {2, 1, 1}}},   {"brick_fly", {"fly", {2, 2, 2}}},
      {"brick_fails_w", {"fails_w", {2, 1, 1}}},   {"brick_fails_free", {"fails_free", {2, 1, 1}}},
      {"brick_fails_s", {"fails_s", {2, 1, 1}}},   {"brick_shared", {"flat_shared", {1, 2, 1}}},
      {"brick_serial", {"flat_serial", {2, 1, 1}}}};
  return all;
}

constexpr int64_t kMostV = (1 << 16) - 1, kMostU = (1 << 17) - 1;

using Recipe = std::function<void(Small&)>;
const std::map<std::string, Recipe>& recipes() {
  using Shape = TableChoice::Shape;
  using S = Small&;
  static const std::map<std::string, Recipe> all{
      {"plain", [](S) {}},
      {"damped",
       [](S s) {
         s.features.damping = 0.2;
         s.features.two_materials = s.features.held = true;
         s.arch.force_pipes = 2;
       }},
      {"pd",
       [](S s) {
         s.features.force_held = true;
         s.arch.overlap = false;
         s.arch.table.degree = 2;
       }},
      {"flat",
       [](S s) {
         s.features.flat = true;
         s.features.size = {2, 2, 1};
       }},
      // Both end where a particle leaves: a node's own fault passes the checks of its links.
      {"detect",
       [](S s) {
         s.arch.link_check = LinkCheck::detect;
         s.features.speed = 0.45;
         s.steps = 20;
       }},
      {"retry",
       [](S s) {
         s.arch.link_check = LinkCheck::retry;
         s.features.speed = 0.45;
         s.steps = 20;
       }},
      // Nodes of 2^k slots that are full from the start, until one more comes.
      {"full",
       [](S s) {
         s.arch.link_check = LinkCheck::retry;
         s.arch.capacity = 4;
         s.features.speed = 0.45;
         s.steps = 20;
         s.change = [](Scene& scene) {
           for (size_t k = 0; k < scene.body.size(); ++k)
             scene.body.v[k] = Vec3(scene.body.x[k].x() < 1.3 ? 0.5 : 0, 0, 0);
         };
       }},
      // Several come to a cell from above in one step.
      {"pour",
       [](S s) {
         s.arch.capacity = 8;
         s.steps = 2;
         s.place = pour_down;
       }},
      // As many lanes as pipes, a row that is not full, differences that are not rounded.
      {"octaves",
       [](S s) {
         s.arch.table = {.shape = Shape::octaves, .degree = 1, .index_bits = 6};
         s.arch.widths.difference_frac = 12;
         s.arch.force_pipes = s.arch.filter_lanes = 3;
         s.arch.capacity = 8;
         s.place = close_together;
       }},
      // One row, one beat per record.
      {"shared",
       [](S s) {
         s.features.damping = 0.2;
         s.arch.table = {.shape = Shape::octaves, .degree = 2, .index_bits = 7};
         s.arch.multipliers = Multipliers::shared;
         s.arch.capacity = s.arch.filter_lanes = 8;
         s.arch.queue_depth = 1;
         s.arch.link_bits = 0;
         s.place = close_together;
       }},
      {"flat_shared",
       [](S s) {
         s.features.flat = s.features.two_materials = true;
         s.features.size = {2, 2, 1};
         s.features.damping = 0.2;
         s.arch.multipliers = Multipliers::shared;
         s.arch.force_pipes = 2;
         s.arch.table.degree = 2;
       }},
      {"flat_pd",
       [](S s) {
         s.features.flat = s.features.force_held = true;
         s.features.size = {2, 2, 1};
         s.arch.table = {.shape = Shape::octaves, .degree = 1, .index_bits = 6};
         s.arch.filter_lanes = 3;
         s.arch.widths.difference_frac = 11;
       }},
      {"pair", [](S s) { s.change = one_pair; }},
      {"fails_w",
       [](S s) {
         failing(s);
         s.place = [](Setup& setup) { set_velocities(setup, 30000, true); };
       }},
      {"fails_w_z",
       [](S s) {
         failing(s);
         s.place = [](Setup& setup) { set_velocities(setup, 30000, true, 2); };
       }},
      {"fails_s",
       [](S s) {
         failing(s);
         s.place = [](Setup& setup) {
           set_velocities(setup, 15000, true);
           close_together(setup);
         };
       }},
      {"fails_sum",
       [](S s) {
         failing(s);
         s.place = [](Setup& setup) { set_velocities(setup, 2500, true); };
       }},
      {"fails_sum_y",
       [](S s) {
         failing(s);
         s.place = [](Setup& setup) { set_velocities(setup, 2500, true, 1); };
       }},
      // One pipe, no PD.
      {"fails_free",
       [](S s) {
         s.features.damping = 8;
         s.arch.widths.sum_bits = 11;
         s.place = [](Setup& setup) { set_velocities(setup, 2500, true); };
       }},
      {"fails_u",
       [](S s) {
         failing(s);
         s.place = [](Setup& setup) {
           set_velocities(setup, 30000, false);
           for (Particle& p : setup.initial.particles)
             if (setup.plan.rule.types[p.type].pd)
               for (int a = 0; a < 3; ++a)
                 p.u[a] = (p.id + static_cast<uint32_t>(a)) % 3 == 0 ? 5 : kMostU - 3 * a;
         };
       }},
      {"fails_v",
       [](S s) {
         failing(s);
         s.place = [](Setup& setup) {
           for (Particle& p : setup.initial.particles)
             for (int a = 0; a < 3; ++a) p.v[a] = kMostV - (p.id * 7 + static_cast<uint32_t>(a) * 5) % 13;
         };
       }},
      {"fails_low_v",
       [](S s) {
         failing(s);
         s.place = [](Setup& setup) {
           for (Particle& p : setup.initial.particles)
             for (int a = 0; a < 3; ++a) p.v[a] = -kMostV + (p.id * 7 + static_cast<uint32_t>(a) * 5) % 13;
         };
       }},
      // Eight nodes, pairs at the cutoff, a coarse planar test.
      {"edge",
       [](S s) {
         s.features.size = {2, 2, 2};
         s.features.jitter = 0.2;
         s.arch.widths.filter_frac = 4;
         s.arch.capacity = 8;
         s.arch.queue_depth = 3;
         s.steps = 3;
         s.place = at_the_cutoff;
       }},
      // Particles go everywhere, along several axes in a step; nodes fill up.
      // One multiplier for the axes, pairs as close as it lets them come, many of them beyond the cutoff; one
      // that fails.
      {"shared_edge",
       [](S s) {
         recipes().at("edge")(s);
         s.arch.multipliers = Multipliers::shared;
       }},
      {"fails_shared_w",
       [](S s) {
         recipes().at("fails_w")(s);
         s.arch.multipliers = Multipliers::shared;
       }},
      {"fails_shared_s",
       [](S s) {
         recipes().at("fails_s")(s);
         s.arch.multipliers = Multipliers::shared;
       }},
      {"hot",
       [](S s) {
         s.features.size = {2, 2, 2};
         s.features.jitter = 0.1;
         s.features.speed = 0.5;
         s.features.gravity = true;
         s.arch.widths.guard = 8;
         s.arch.widths.velocity_bits = s.arch.widths.sum_bits = 21;
         s.steps = 12;
         s.place = cross_the_corner;
       }},
      {"drift",
       [](S s) {
         s.features.flat = true;
         s.features.size = {4, 4, 1};
         s.arch.overlap = false;
         s.arch.queue_depth = 1;
         s.arch.filter_lanes = 3;
         s.steps = 30;
         s.change = drift;
       }},
      {"fly",
       [](S s) {
         s.arch.capacity = 2;
         s.steps = 300;
         s.change = fly;
       }},
      // Pairs that wait for one another in two pipes of serial multipliers, behind a queue.
      {"serial",
       [](S s) {
         s.features.damping = 0.2;
         s.arch.table.degree = 2;
         s.arch.multipliers = Multipliers::serial;
         s.arch.force_pipes = 2;
       }},
      {"flat_serial",
       [](S s) {
         s.features.flat = s.features.two_materials = true;
         s.features.size = {2, 2, 1};
         s.features.damping = 0.2;
         s.arch.table = {.shape = Shape::octaves, .degree = 2, .index_bits = 7};
         s.arch.multipliers = Multipliers::serial;
         s.arch.force_pipes = 2;
         s.arch.queue_depth = 1;
       }},
      {"narrow",
       [](S s) {
         s.features.force_held = true;
         s.arch.multipliers = Multipliers::shared;
         s.arch.table = {.shape = Shape::octaves, .degree = 2, .index_bits = 7};
         narrow(s.arch);
         s.place = close_together;
       }},
      // One word per record.
      {"narrow_serial",
       [](S s) {
         s.features.damping = 0.2;
         s.features.two_materials = s.features.held = true;
         s.arch.multipliers = Multipliers::serial;
         s.arch.link_bits = 0;
         narrow(s.arch);
       }},
      // A pair may follow another in the next cycle; nodes fill up, and some are empty.
      {"narrow_hot",
       [](S s) {
         s.features.size = {2, 2, 2};
         s.features.jitter = 0.1;
         s.features.speed = 0.5;
         s.features.gravity = true;
         s.arch.widths.guard = 8;
         s.arch.widths.velocity_bits = s.arch.widths.sum_bits = 21;
         s.arch.link_bits = 9;
         narrow(s.arch);
         s.steps = 12;
         s.place = cross_the_corner;
       }},
      {"narrow_flat",
       [](S s) {
         s.features.flat = true;
         s.features.size = {4, 4, 1};
         s.arch.multipliers = Multipliers::serial;
         narrow(s.arch);
         s.steps = 30;
         s.change = drift;
       }},
      // A candidate at the cutoff, a coarse planar test, words that are longer than a halo record.
      {"narrow_edge",
       [](S s) {
         s.features.size = {2, 2, 2};
         s.features.jitter = 0.2;
         s.arch.widths.filter_frac = 4;
         s.arch.capacity = 8;
         s.arch.link_bits = 50;
         s.arch.multipliers = Multipliers::shared;
         narrow(s.arch);
         s.steps = 3;
         s.place = at_the_cutoff;
       }},
      {"narrow_full",
       [](S s) {
         s.arch.link_check = LinkCheck::retry;
         s.arch.capacity = 4;
         narrow(s.arch);
         s.features.speed = 0.45;
         s.steps = 20;
         s.change = [](Scene& scene) {
           for (size_t k = 0; k < scene.body.size(); ++k)
             scene.body.v[k] = Vec3(scene.body.x[k].x() < 1.3 ? 0.5 : 0, 0, 0);
         };
       }},
      {"narrow_fails_sum",
       [](S s) {
         failing(s);
         narrow(s.arch);
         s.place = [](Setup& setup) { set_velocities(setup, 2500, true); };
       }},
      {"narrow_fails_u",
       [](S s) {
         recipes().at("fails_u")(s);
         narrow(s.arch);
       }},
      {"narrow_fails_v",
       [](S s) {
         recipes().at("fails_v")(s);
         narrow(s.arch);
       }},
      {"narrow_fails_w",
       [](S s) {
         recipes().at("fails_w")(s);
         narrow(s.arch);
       }},
      // Halos used on arrival: particles go everywhere, nodes fill up, some are empty.
      {"arrival",
       [](S s) {
         recipes().at("hot")(s);
         s.arch.halos = Halos::arrival;
       }},
      // Two streamers of one pipe each; records at the cutoff of a particle in the box, a coarse planar test.
      {"arrival_two",
       [](S s) {
         recipes().at("edge")(s);
         s.features.damping = 0.2;
         s.features.two_materials = true;
         s.arch.halos = Halos::arrival;
         s.arch.streamers = s.arch.force_pipes = 2;
       }},
      // The same in two nodes: small enough for netlists.
      {"arrival_damped",
       [](S s) {
         recipes().at("damped")(s);
         s.arch.halos = Halos::arrival;
         s.arch.streamers = 2;
       }},
      {"arrival_flat",
       [](S s) {
         recipes().at("drift")(s);
         s.arch.overlap = true;
         s.arch.halos = Halos::arrival;
         s.arch.streamers = s.arch.force_pipes = 2;
       }},
      // One beat per record, one row, PD: an update of three cycles more.
      {"arrival_pd",
       [](S s) {
         recipes().at("pd")(s);
         s.arch.overlap = true;
         s.arch.halos = Halos::arrival;
         s.arch.capacity = s.arch.filter_lanes = 8;
         s.arch.link_bits = 0;
       }},
      // Ends where a particle leaves.
      {"arrival_retry",
       [](S s) {
         recipes().at("retry")(s);
         s.arch.halos = Halos::arrival;
       }},
      // Ends where one particle too many comes.
      {"arrival_full",
       [](S s) {
         recipes().at("full")(s);
         s.arch.halos = Halos::arrival;
       }},
      {"arrival_fly",
       [](S s) {
         recipes().at("fly")(s);
         s.steps = 60;
         s.arch.halos = Halos::arrival;
       }},
      {"arrival_fails_sum",
       [](S s) {
         recipes().at("fails_sum")(s);
         s.arch.halos = Halos::arrival;
         s.arch.streamers = 2;
       }},
  };
  return all;
}

}  // namespace

std::vector<std::string> small_names() {
  std::vector<std::string> names;
  for (const auto& [name, recipe] : recipes()) names.push_back(name);
  for (const auto& [name, brick] : bricks()) names.push_back(name);
  return names;
}

Case small_case(const std::string& name) {
  Small s;
  s.arch = small_arch();
  const auto brick = bricks().find(name);
  recipes().at(brick == bricks().end() ? name : brick->second.first)(s);
  if (brick != bricks().end()) s.arch.brick = brick->second.second;
  Case c{"small_" + name, {}, s.steps};
  c.scene = block_scene(s.features);
  if (s.change) s.change(c.scene);
  c.setup = make_setup(c.scene, s.arch);
  if (s.place) s.place(c.setup);
  return c;
}

}  // namespace cuboct::test
