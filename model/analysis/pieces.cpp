// SPDX-License-Identifier: MIT
#include "model/analysis/pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "model/analysis/clusters.h"
#include "model/analysis/crack.h"
#include "model/analysis/motion.h"
#include "model/base/dense.h"
#include "model/contract/material_name.h"
#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

constexpr std::array kEveryAxis{true, true, true};

bool is_fixed(const ParticleType& type) { return type.imposed == kEveryAxis && type.velocity.isZero(0); }

bool free_somewhere(const ParticleType& type) { return !type.pd && type.imposed != kEveryAxis; }

std::vector<std::vector<double>> squared_reaches(const Rule& rule) {
  const int count = static_cast<int>(rule.types.size());
  std::vector<std::vector<double>> squared(rule.types.size(), std::vector<double>(rule.types.size()));
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j)
      squared[i][j] = std::pow(std::min(bond_reach(rule, i, j), rule.cutoff()), 2);
  return squared;
}

// With a box too small for a list of neighbours all is one piece: engines refuse the scene.
Clusters connected(const Scene& scene) {
  const Body& body = scene.body;
  Clusters clusters(body.size());
  const double cutoff = scene.rule.cutoff();
  for (const double extent : scene.periodic.extent)
    if (extent > 0 && extent < 2 * cutoff) {
      for (uint32_t i = 1; i < body.size(); ++i) clusters.join(0, i);
      return clusters;
    }
  const auto squared = squared_reaches(scene.rule);
  CellList cells(cutoff, scene.periodic);
  cells.build(body.x);
  cells.for_each_pair(body.x, [&](uint32_t i, uint32_t j, const Vec3&, double r) {
    if (r * r < squared[body.type[i]][body.type[j]]) clusters.join(i, j);
  });
  return clusters;
}

// Of each particle that is free along some axis: its type, mass, place and velocity.
void over_free(const Scene& scene, const Piece& piece, auto see) {
  const Body& body = scene.body;
  for (const uint32_t i : piece.ids)
    if (const ParticleType& type = scene.rule.types[body.type[i]]; free_somewhere(type))
      see(type, scene.rule.mass_of(body.type[i]), body.x[i], body.v[i]);
}

// Along each axis of the particles that are free along it: their mean by mass, and bounds.
void read_means(const Scene& scene, Piece& piece) {
  Vec3 masses = Vec3::Zero();
  double mass = 0;
  over_free(scene, piece, [&](const ParticleType& type, double m, const Vec3& x, const Vec3& v) {
    mass += m, piece.centre += m * x;
    for (int a = 0; a < 3; ++a) {
      if (!is_free(type, a)) continue;
      if (masses[a] == 0) piece.velocities.low[a] = piece.velocities.high[a] = v[a];
      masses[a] += m, piece.velocity[a] += m * v[a];
      piece.velocities.low[a] = std::min(piece.velocities.low[a], v[a]);
      piece.velocities.high[a] = std::max(piece.velocities.high[a], v[a]);
    }
  });
  if (mass > 0) piece.centre /= mass;
  for (int a = 0; a < 3; ++a)
    if (masses[a] > 0) piece.velocity[a] /= masses[a];
}

// The rotation that is nearest to the particles' velocities: least squares, by mass. A piece turns about an
// axis where nothing holds it along the other two. In a box that repeats a rotation means nothing.
Vec3 spin_of(const Scene& scene, const Piece& piece) {
  if (!scene.periodic.extent.isZero(0)) return Vec3::Zero();
  Vec3 turning = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  over_free(scene, piece, [&](const ParticleType&, double m, const Vec3& x, const Vec3& v) {
    const Vec3 r = x - piece.centre;
    turning += m * r.cross(v - piece.velocity);
    inertia += m * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  });
  for (int a = 0; a < 3; ++a)
    if (piece.steers((a + 1) % 3) || piece.steers((a + 2) % 3))
      turning[a] = 0, inertia.row(a).setZero(), inertia.col(a).setZero();
  return least_squares(inertia, turning);
}

// The motion of a rigid body that is nearest to the particles', and what it leaves.
void read_velocities(const Scene& scene, Piece& piece) {
  read_means(scene, piece);
  piece.spin = spin_of(scene, piece);
  double squares = 0, count = 0;
  over_free(scene, piece, [&](const ParticleType& type, double, const Vec3& x, const Vec3& v) {
    Vec3 left = v - piece.velocity - piece.spin.cross(x - piece.centre);
    for (int a = 0; a < 3; ++a)
      if (!is_free(type, a)) left[a] = 0;
    piece.inner = piece.inner.cwiseMax(left.cwiseAbs());
    squares += left.squaredNorm(), ++count;
  });
  if (count == 0) return;
  piece.inner_rms = std::sqrt(squares / count);
  // What rounding leaves of a fit is no motion.
  const double least =
      1e-9 * piece.velocities.low.cwiseAbs().cwiseMax(piece.velocities.high.cwiseAbs()).norm();
  piece.inner = piece.inner.map([&](double c) { return c > least ? c : 0; });
  if (piece.inner_rms <= least) piece.inner_rms = 0;
  if (piece.spin.norm() * piece.size().norm() <= least) piece.spin = Vec3::Zero();
}

void read_facts(const Scene& scene, Piece& piece) {
  const std::vector<ParticleType>& types = scene.rule.types;
  piece.name = material_of(types[scene.body.type[piece.ids.front()]].name);
  piece.fixed = true;
  Vec3 free_mass = Vec3::Zero();
  for (const uint32_t i : piece.ids) {
    const Vec3& x = scene.body.x[i];
    const ParticleType& type = types[scene.body.type[i]];
    const double mass = scene.rule.mass_of(scene.body.type[i]);
    piece.mass += mass;
    piece.low = piece.low.cwiseMin(x), piece.high = piece.high.cwiseMax(x);
    piece.fixed = piece.fixed && is_fixed(type);
    if (free_somewhere(type)) {
      piece.most_acceleration = std::max(piece.most_acceleration, type.gravity.norm());
      piece.pulled = piece.pulled || !type.pull.isZero(0);
    }
    for (int a = 0; a < 3; ++a) {
      if (is_free(type, a)) {
        free_mass[a] += mass, piece.acceleration[a] += mass * type.gravity[a];
        continue;
      }
      piece.driven = true;
      Piece::Hold& hold = piece.hold[static_cast<size_t>(a)];
      if (!hold.any) piece.led.low[a] = piece.led.high[a] = type.velocity[a];
      hold.any = true;
      hold.low = hold.low.cwiseMin(x), hold.high = hold.high.cwiseMax(x);
      piece.led.low[a] = std::min(piece.led.low[a], type.velocity[a]);
      piece.led.high[a] = std::max(piece.led.high[a], type.velocity[a]);
    }
  }
  for (int a = 0; a < 3; ++a) {
    if (!(free_mass[a] > 0)) continue;
    piece.led.low[a] = std::min(piece.led.low[a], 0.0), piece.led.high[a] = std::max(piece.led.high[a], 0.0);
    piece.acceleration[a] /= free_mass[a];
  }
  read_velocities(scene, piece);
}

using Ids = std::vector<uint32_t>;

// Of pieces that are gathered: nothing holds or leads them, all of them is held at rest, or else.
enum class PieceKind { loose, fixed, led };

PieceKind kind_of(const Scene& scene, const Ids& ids) {
  bool loose = true, fixed = true;
  for (const uint32_t i : ids) {
    const ParticleType& type = scene.rule.types[scene.body.type[i]];
    loose = loose && !driven(type), fixed = fixed && is_fixed(type);
  }
  return loose ? PieceKind::loose : fixed ? PieceKind::fixed : PieceKind::led;
}

struct Group {
  Ids ids;
  PieceKind kind;
  size_t pieces = 1;
};

// Puts all groups of a kind into the first of them.
void gather(PieceKind kind, std::vector<Group>& groups) {
  const auto is = [&](const Group& group) { return group.kind == kind; };
  const auto first = std::ranges::find_if(groups, is);
  if (first == groups.end()) return;
  for (auto other = first + 1; other != groups.end(); ++other)
    if (is(*other))
      first->ids.insert(first->ids.end(), other->ids.begin(), other->ids.end()), ++first->pieces;
  std::ranges::sort(first->ids);
  groups.erase(std::remove_if(first + 1, groups.end(), is), groups.end());
}

}  // namespace

std::vector<Piece> pieces_of(const Scene& scene, size_t most) {
  Clusters clusters = connected(scene);
  std::vector<Group> groups;
  std::vector<uint32_t> number(scene.body.size());
  for (uint32_t i = 0; i < scene.body.size(); ++i) {
    const uint32_t root = clusters.find(i);
    if (root == i)
      number[i] = static_cast<uint32_t>(groups.size()), groups.push_back({.ids = {}, .kind = {}});
    groups[number[root]].ids.push_back(i);
  }
  for (Group& group : groups) group.kind = kind_of(scene, group.ids);
  for (const PieceKind kind : {PieceKind::loose, PieceKind::fixed, PieceKind::led})
    if (groups.size() > most) gather(kind, groups);
  std::vector<Piece> pieces;
  for (Group& group : groups) {
    Piece& piece = pieces.emplace_back();
    piece.ids = std::move(group.ids), piece.pieces = group.pieces;
    read_facts(scene, piece);
  }
  return pieces;
}

}  // namespace cuboct
