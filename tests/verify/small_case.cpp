// SPDX-License-Identifier: MIT
#include "tests/verify/small_case.h"

#include <map>

#include "tests/support/recipe.h"

namespace cuboct::test {
namespace {

constexpr const char* kSmallArch =
    "capacity=7 lanes=2 queue=2 link_bits=13 guard=4 difference_frac=9 velocity_bits=17 sum_bits=17 uniform "
    "degree=1 index_bits=5";

Recipe smallest() {
  Recipe r;
  r.features = {.size = {2, 1, 1}, .cutoff = 1.4, .jitter = 0.05, .speed = 0.3, .margin = 0};
  r.steps = 6;
  season(r, kSmallArch);
  Widths& w = r.arch.widths;
  w.position_frac = 12, w.relative_velocity_frac = 12, w.relative_velocity_bits = 12;
  w.strength_bits = 12, w.displacement_bits = 18;
  w.scale_frac = 8;
  return r;
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

// Those of the left half fly to the right, until one more comes than a node holds.
void press(Scene& scene) {
  for (size_t k = 0; k < scene.body.size(); ++k)
    scene.body.v[k] = Vec3(scene.body.x[k].x() < 1.3 ? 0.5 : 0, 0, 0);
}

template <int64_t V, bool by_turns, int first = 0>
void fly_at(Setup& setup) {
  set_velocities(setup, V, by_turns, first);
}

void meet_close_together(Setup& setup) {
  set_velocities(setup, 15000, true);
  close_together(setup);
}

constexpr int64_t kMostV = (1 << 16) - 1, kMostU = (1 << 17) - 1;

void far_from_rest(Setup& setup) {
  set_velocities(setup, 30000, false);
  for (Particle& p : setup.initial.particles)
    if (setup.plan.rule.types[p.type].pd)
      for (int a = 0; a < 3; ++a) p.u[a] = (p.id + static_cast<uint32_t>(a)) % 3 == 0 ? 5 : kMostU - 3 * a;
}

template <int64_t sign>
void near_most_v(Setup& setup) {
  for (Particle& p : setup.initial.particles)
    for (int a = 0; a < 3; ++a) p.v[a] = sign * (kMostV - (p.id * 7 + static_cast<uint32_t>(a) * 5) % 13);
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

// One rule and machine with damping and PD, of which every number is near its limit; where particles start is
// what it makes fail, of several particles, pairs and axes in one step.
constexpr const char* kFailing = "damping=8 force_held speed=0 pipes=2 sum_bits=11 steps=3";

struct Row {
  const char* words;
  void (*place)(Setup&) = nullptr;   // where particles start
  void (*change)(Scene&) = nullptr;  // the scene, before it is quantised
  const char* like = nullptr;        // the row that this one adds to
};

const std::map<std::string, Row>& rows() {
  static const std::map<std::string, Row> all{
      {"plain", {""}},
      {"damped", {"damping=0.2 two_materials held pipes=2"}},
      {"pd", {"force_held no_overlap degree=2"}},
      {"flat", {"flat size=2x2x1"}},
      // Both end where a particle leaves: a node's own fault passes the checks of its links.
      {"detect", {"detect speed=0.45 steps=20"}},
      {"retry", {"retry speed=0.45 steps=20"}},
      // Nodes of 2^k slots that are full from the start.
      {"full", {"retry capacity=4 speed=0.45 steps=20", nullptr, press}},
      // Several come to a cell from above in one step.
      {"pour", {"capacity=8 steps=2", pour_down}},
      // As many lanes as pipes, a row that is not full, differences that are not rounded.
      {"octaves", {"octaves index_bits=6 difference_frac=12 pipes=3 lanes=3 capacity=8", close_together}},
      // One row, one beat per record.
      {"shared",
       {"damping=0.2 octaves degree=2 index_bits=7 shared capacity=8 lanes=8 queue=1 link_bits=0",
        close_together}},
      {"flat_shared", {"flat two_materials size=2x2x1 damping=0.2 shared pipes=2 degree=2"}},
      {"flat_pd", {"flat force_held size=2x2x1 octaves index_bits=6 lanes=3 difference_frac=11"}},
      {"pair", {"", nullptr, one_pair}},
      {"fails_w", {kFailing, fly_at<30000, true>}},
      {"fails_w_z", {kFailing, fly_at<30000, true, 2>}},
      {"fails_s", {kFailing, meet_close_together}},
      {"fails_sum", {kFailing, fly_at<2500, true>}},
      {"fails_sum_y", {kFailing, fly_at<2500, true, 1>}},
      // One pipe, no PD.
      {"fails_free", {"damping=8 sum_bits=11", fly_at<2500, true>}},
      {"fails_u", {kFailing, far_from_rest}},
      {"fails_v", {kFailing, near_most_v<1>}},
      {"fails_low_v", {kFailing, near_most_v<-1>}},
      // Eight nodes, pairs at the cutoff, a coarse planar test.
      {"edge", {"size=2x2x2 jitter=0.2 filter_frac=4 capacity=8 queue=3 steps=3", at_the_cutoff}},
      // One multiplier for the axes, pairs as close as it lets them come, many of them beyond the cutoff; one
      // that fails.
      {"shared_edge", {.words = "shared", .like = "edge"}},
      {"fails_shared_w", {.words = "shared", .like = "fails_w"}},
      {"fails_shared_s", {.words = "shared", .like = "fails_s"}},
      // Particles go everywhere, along several axes in a step; nodes fill up.
      {"hot",
       {"size=2x2x2 jitter=0.1 speed=0.5 gravity guard=8 velocity_bits=21 sum_bits=21 steps=12",
        cross_the_corner}},
      {"drift", {"flat size=4x4x1 no_overlap queue=1 lanes=3 steps=30", nullptr, drift}},
      {"fly", {"capacity=2 steps=300", nullptr, fly}},
      // Pairs that wait for one another in two pipes of serial multipliers, behind a queue.
      {"serial", {"damping=0.2 degree=2 serial pipes=2"}},
      {"flat_serial",
       {"flat two_materials size=2x2x1 damping=0.2 octaves degree=2 index_bits=7 serial pipes=2 queue=1"}},
      {"narrow", {"force_held shared octaves degree=2 index_bits=7 narrow", close_together}},
      // One word per record.
      {"narrow_serial", {"damping=0.2 two_materials held serial link_bits=0 narrow"}},
      // A pair may follow another in the next cycle; nodes fill up, and some are empty.
      {"narrow_hot", {.words = "link_bits=9 narrow", .like = "hot"}},
      {"narrow_flat", {"flat size=4x4x1 serial narrow steps=30", nullptr, drift}},
      // A candidate at the cutoff, a coarse planar test, words that are longer than a halo record.
      {"narrow_edge",
       {"size=2x2x2 jitter=0.2 filter_frac=4 capacity=8 link_bits=50 shared narrow steps=3", at_the_cutoff}},
      {"narrow_full", {.words = "narrow", .like = "full"}},
      {"narrow_fails_sum", {.words = "narrow", .like = "fails_sum"}},
      {"narrow_fails_u", {.words = "narrow", .like = "fails_u"}},
      {"narrow_fails_v", {.words = "narrow", .like = "fails_v"}},
      {"narrow_fails_w", {.words = "narrow", .like = "fails_w"}},
      // Halos used on arrival: particles go everywhere, nodes fill up, some are empty.
      {"arrival", {.words = "arrival", .like = "hot"}},
      // Two streamers of one pipe each; records at the cutoff of a particle in the box, a coarse planar test.
      {"arrival_two", {.words = "damping=0.2 two_materials arrival streamers=2 pipes=2", .like = "edge"}},
      // The same in two nodes: small enough for netlists.
      {"arrival_damped", {.words = "arrival streamers=2", .like = "damped"}},
      {"arrival_flat", {.words = "overlap arrival streamers=2 pipes=2", .like = "drift"}},
      // One beat per record, one row, PD: an update of three cycles more.
      {"arrival_pd", {.words = "overlap arrival capacity=8 lanes=8 link_bits=0", .like = "pd"}},
      // Ends where a particle leaves.
      {"arrival_retry", {.words = "arrival", .like = "retry"}},
      // Ends where one particle too many comes.
      {"arrival_full", {.words = "arrival", .like = "full"}},
      {"arrival_fly", {.words = "steps=60 arrival", .like = "fly"}},
      {"arrival_fails_sum", {.words = "arrival streamers=2", .like = "fails_sum"}},
  };
  return all;
}

}  // namespace

std::vector<std::string> small_names() {
  std::vector<std::string> names;
  for (const auto& [name, row] : rows()) names.push_back(name);
  for (const auto& [name, brick] : bricks()) names.push_back(name);
  return names;
}

Case small_case(const std::string& name) {
  Recipe recipe = smallest();
  const auto brick = bricks().find(name);
  Row row = rows().at(brick == bricks().end() ? name : brick->second.first);
  if (row.like != nullptr) {
    const Row& first = rows().at(row.like);
    season(recipe, first.words);
    row.place = first.place, row.change = first.change;
  }
  season(recipe, row.words);
  if (brick != bricks().end()) recipe.arch.brick = brick->second.second;
  Case c{"small_" + name, {}, recipe.steps};
  c.scene = block_scene(recipe.features);
  if (row.change != nullptr) row.change(c.scene);
  c.setup = make_setup(c.scene, recipe.arch);
  if (row.place != nullptr) row.place(c.setup);
  return c;
}

}  // namespace cuboct::test
