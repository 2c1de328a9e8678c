// SPDX-License-Identifier: MIT
#include "model/analysis/pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Dense>

#include "model/analysis/clusters.h"
#include "model/analysis/crack.h"
#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

constexpr std::array kEveryAxis{true, true, true};
constexpr std::array kNoAxis{false, false, false};

bool steered(const ParticleType& type) { return type.pd || type.imposed != kNoAxis; }

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

// The motion of a rigid body that is nearest to the particles': least squares, by mass.
void read_velocities(const Scene& scene, Piece& piece) {
  const Body& body = scene.body;
  const auto each_free = [&](auto see) {
    for (const uint32_t i : piece.ids)
      if (!steered(scene.rule.types[body.type[i]]))
        see(scene.rule.mass_of(body.type[i]), body.x[i], body.v[i]);
  };
  double mass = 0, count = 0;
  each_free([&](double m, const Vec3& x, const Vec3& v) {
    if (count == 0) piece.velocities = {v, v};
    mass += m, ++count, piece.centre += m * x, piece.velocity += m * v;
    piece.velocities.low = piece.velocities.low.cwiseMin(v);
    piece.velocities.high = piece.velocities.high.cwiseMax(v);
  });
  if (mass == 0) return;
  piece.centre /= mass, piece.velocity /= mass;
  Vec3 turning = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  each_free([&](double m, const Vec3& x, const Vec3& v) {
    const Vec3 r = x - piece.centre;
    turning += m * r.cross(v - piece.velocity);
    inertia += m * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  });
  // A rotation in a box that repeats means nothing.
  if (scene.periodic.extent.isZero(0)) piece.spin = inertia.completeOrthogonalDecomposition().solve(turning);
  double squares = 0;
  each_free([&](double, const Vec3& x, const Vec3& v) {
    const Vec3 left = v - piece.velocity - piece.spin.cross(x - piece.centre);
    piece.inner = piece.inner.cwiseMax(left.cwiseAbs());
    squares += left.squaredNorm();
  });
  piece.inner_rms = std::sqrt(squares / count);
  // What rounding leaves of a fit is no motion.
  const double least =
      1e-9 * piece.velocities.low.cwiseAbs().cwiseMax(piece.velocities.high.cwiseAbs()).norm();
  piece.inner = (piece.inner.array() > least).select(piece.inner, 0);
  if (piece.inner_rms <= least) piece.inner_rms = 0;
  if (piece.spin.norm() * piece.size().norm() <= least) piece.spin = Vec3::Zero();
}

void read_facts(const Scene& scene, Piece& piece) {
  const std::vector<ParticleType>& types = scene.rule.types;
  const std::string& name = types[scene.body.type[piece.ids.front()]].name;
  piece.name = name.substr(0, name.find('/'));
  piece.fixed = true;
  bool first = true, all_led = true;
  double free_mass = 0;
  for (const uint32_t i : piece.ids) {
    const Vec3& x = scene.body.x[i];
    const ParticleType& type = types[scene.body.type[i]];
    const double mass = scene.rule.mass_of(scene.body.type[i]);
    piece.mass += mass;
    piece.low = piece.low.cwiseMin(x), piece.high = piece.high.cwiseMax(x);
    piece.fixed = piece.fixed && type.imposed == kEveryAxis && type.velocity.isZero(0);
    if (!steered(type)) {
      all_led = false;
      free_mass += mass, piece.acceleration += mass * type.gravity;
      piece.most_acceleration = std::max(piece.most_acceleration, type.gravity.norm());
      piece.pulled = piece.pulled || !type.pull.isZero(0);
      continue;
    }
    piece.driven = true;
    piece.held_low = piece.held_low.cwiseMin(x), piece.held_high = piece.held_high.cwiseMax(x);
    if (first) piece.led = {type.velocity, type.velocity};
    first = false;
    piece.led.low = piece.led.low.cwiseMin(type.velocity);
    piece.led.high = piece.led.high.cwiseMax(type.velocity);
    piece.fastest_led = std::max(piece.fastest_led, type.velocity.norm());
  }
  if (!all_led) piece.led = {piece.led.low.cwiseMin(0), piece.led.high.cwiseMax(0)};
  if (free_mass > 0) piece.acceleration /= free_mass;
  read_velocities(scene, piece);
}

struct PieceKind {
  bool driven, fixed;
};

// Puts all pieces of a kind into the first of them.
void gather(const Scene& scene, const PieceKind& kind, std::vector<Piece>& pieces) {
  const auto is = [&](const Piece& piece) {
    return piece.driven == kind.driven && piece.fixed == kind.fixed;
  };
  const auto first = std::ranges::find_if(pieces, is);
  if (first == pieces.end()) return;
  Piece all;
  all.pieces = 0;
  for (const Piece& piece : pieces)
    if (is(piece)) all.ids.insert(all.ids.end(), piece.ids.begin(), piece.ids.end()), ++all.pieces;
  std::ranges::sort(all.ids);
  read_facts(scene, all);
  *first = std::move(all);
  pieces.erase(std::remove_if(first + 1, pieces.end(), is), pieces.end());
}

}  // namespace

std::vector<Piece> pieces_of(const Scene& scene, size_t most) {
  Clusters clusters = connected(scene);
  std::vector<Piece> pieces;
  std::vector<uint32_t> number(scene.body.size());
  for (uint32_t i = 0; i < scene.body.size(); ++i) {
    const uint32_t root = clusters.find(i);
    if (root == i) number[i] = static_cast<uint32_t>(pieces.size()), pieces.emplace_back();
    pieces[number[root]].ids.push_back(i);
  }
  for (Piece& piece : pieces) read_facts(scene, piece);
  for (const auto& kind : {PieceKind{false, false}, PieceKind{true, true}, PieceKind{true, false}})
    if (pieces.size() > most) gather(scene, kind, pieces);
  return pieces;
}

}  // namespace cuboct
