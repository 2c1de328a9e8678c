// SPDX-License-Identifier: MIT
// Small bodies for tests.
#pragma once

#include <numbers>
#include <random>

#include "model/contract/rule.h"

namespace cuboct::test {

// cells^3 cubic cells of an FCC packing of that pitch; fills the box [0, cells * sqrt(2) * pitch)^3.
inline Body fcc_block(int cells, double pitch) {
  const double edge = std::numbers::sqrt2 * pitch;
  Body body;
  for (int z = 0; z < 2 * cells; ++z) {
    for (int y = 0; y < 2 * cells; ++y) {
      for (int x = 0; x < 2 * cells; ++x) {
        if ((x + y + z) % 2 == 0) body.x.push_back(edge / 2 * Vec3(x, y, z));
      }
    }
  }
  body.v.assign(body.size(), Vec3::Zero());
  body.type.assign(body.size(), 0);
  return body;
}

inline Periodic fcc_box(int cells, double pitch) {
  Periodic box;
  box.extent = Vec3::Constant(cells * std::numbers::sqrt2 * pitch);
  return box;
}

// Uniform in [-1, 1]^3, the same on every platform.
inline Vec3 random_vector(std::mt19937_64& generator) {
  Vec3 v;
  for (int axis = 0; axis < 3; ++axis) v[axis] = static_cast<double>(generator() >> 11) * 0x1p-52 - 1;
  return v;
}

// Moves each particle by up to `shift` per axis and gives it a velocity of up to `speed` per axis; no total
// momentum.
inline void shake(Body& body, double shift, double speed, uint64_t seed) {
  std::mt19937_64 generator(seed);
  Vec3 mean = Vec3::Zero();
  for (size_t i = 0; i < body.size(); ++i) {
    body.x[i] += shift * random_vector(generator);
    body.v[i] = speed * random_vector(generator);
    mean += body.v[i] / static_cast<double>(body.size());
  }
  for (Vec3& v : body.v) v -= mean;
}

// One material, one free type.
inline Rule simple_rule(std::shared_ptr<const PairLaw> law, double mass, double dt) {
  Rule rule;
  rule.law = std::move(law);
  rule.mass = mass;
  rule.dt = dt;
  rule.types.resize(1);
  rule.types[0].name = "free";
  rule.strength = {{1.0}};
  return rule;
}

}  // namespace cuboct::test
