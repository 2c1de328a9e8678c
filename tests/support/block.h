// SPDX-License-Identifier: MIT
// Small scenes made by hand: an FCC block (pitch 1 m, unit mass) under a soft bond law, with as many features
// as asked.
#pragma once

#include <cmath>
#include <random>

#include "hw/plan/setup.h"
#include "model/contract/law.h"

namespace cuboct::test {

// f(r) = k (1-r) (1-(r/c)^2)^2 / r^2 for core <= r < c: zero at the pitch and, twice, at the cutoff.
class BondLaw : public PairLaw {
 public:
  BondLaw(double stiffness, double cutoff) : k_(stiffness), c_(cutoff) {}
  double force(double r) const override {
    if (r >= c_) return 0;
    const double near = std::max(r, core()), q = 1 - near * near / (c_ * c_);
    return k_ * (1 - near) * q * q / (near * near) * (r / near);
  }
  double energy(double r) const override {
    if (r >= c_) return 0;
    // The integral of (1-r) (1/r^2 - 2/c^2 + r^2/c^4), and of the line below the core.
    const double near = std::max(r, core()), c2 = c_ * c_;
    const auto whole = [&](double s) {
      return -1 / s - std::log(s) - 2 * s / c2 + s * s / c2 + s * s * s / (3 * c2 * c2) -
             s * s * s * s / (4 * c2 * c2);
    };
    const double below = r < near ? force(near) / near * (near * near - r * r) / 2 : 0;
    return k_ * (whole(c_) - whole(near)) + below;
  }
  double slope(double r) const override { return (force(r + 1e-6) - force(r - 1e-6)) / 2e-6; }
  double cutoff() const override { return c_; }
  double core() const override { return 0.5; }

 private:
  double k_, c_;
};

struct Features {
  Cell size{3, 3, 3};  // conventional cells of 4 particles, edge sqrt(2)
  double cutoff = 1.6;
  double dt = 0.15;      // of 1/sqrt(k/m)
  double jitter = 0.02;  // of the pitch, uniform per axis
  double speed = 0.02;   // pitch per unit time, uniform per axis
  double damping = 0;
  bool two_materials = false;  // weaker in the upper half of x
  bool contact = false;        // the two only touch
  bool masses = false;         // those of the upper half are heavier
  bool laws = false;           // each pair of the two has its own law
  bool held = false;           // lowest plane of x held; the highest moved
  bool force_held = false;     // the same by PD
  bool gravity = false;
  double margin = -1;  // m
  bool flat = false;   // one layer, a square lattice of the pitch turned by 45 degrees, with nothing along z
  uint64_t seed = 1;
};

// Leaves the particles of the lowest plane, and takes everything along z from them.
inline void flatten(Scene& scene) {
  Body sheet;
  for (size_t k = 0; k < scene.body.size(); ++k) {
    Vec3 x = scene.body.x[k], v = scene.body.v[k];
    if (x.z() > 0.4) continue;
    x.z() = 0.3, v.z() = 0;
    sheet.x.push_back(x), sheet.v.push_back(v), sheet.type.push_back(scene.body.type[k]);
  }
  scene.body = sheet;
  for (ParticleType& type : scene.rule.types) type.velocity.z() = type.gravity.z() = 0;
}

inline Scene block_scene(const Features& f) {
  Scene scene;
  scene.path = "block";
  scene.pitch = 1;
  scene.steps = 100;
  scene.reach_margin = Vec3::Constant(f.margin);
  Rule& rule = scene.rule;
  rule.law = std::make_shared<BondLaw>(1.0, f.cutoff);
  rule.damping.coefficient = f.damping;
  rule.mass = 1;
  rule.dt = f.dt;
  rule.strength = {{1.0}};
  if (f.two_materials) rule.strength = {{1.0, 0.625}, {0.625, 0.3}};
  if (f.two_materials && f.contact) {
    rule.contact = {{0, 1}, {1, 0}};
    rule.contact_distance = push_end(*rule.law);
  }
  if (f.two_materials && f.masses) rule.masses = {1, 2.7};
  if (f.two_materials && f.laws) {
    // The one ends before the first; the other rests elsewhere, with another core.
    rule.other_laws = {std::make_shared<BondLaw>(0.6, 0.8 * f.cutoff), preset_law("brittle", 0.95, 0.8)};
    rule.law_index = {{0, 2}, {2, 1}};
  }

  std::mt19937_64 random(f.seed);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0; };
  const double edge = std::sqrt(2.0), width = f.size[0] * edge;
  const auto type_of = [&](double x) {
    ParticleType type{.name = "bulk"};
    if (f.two_materials && x > 0.5 * width) type.material = 1;
    const bool low = x<0.1, high = x> width - 0.8;
    if (low || high) {
      if (f.held) type.imposed = {true, true, true};
      type.pd = f.force_held;
      if (f.force_held) type.kp = 1.5, type.kd = 0.3;
      if ((f.held || f.force_held) && high) type.velocity = Vec3(0.01, 0, -0.002);
    }
    if (f.gravity) type.gravity = Vec3(0, 0, -1e-3);
    return type;
  };
  std::vector<std::pair<double, double>> keys;  // what tells types apart: material and role
  // Drawn from the last axis to the first: arguments of a call have no order.
  const auto any = [&uniform] {
    const double z = uniform(), y = uniform(), x = uniform();
    return Vec3(x, y, z);
  };
  for (int z = 0; z < f.size[2]; ++z)
    for (int y = 0; y < f.size[1]; ++y)
      for (int x = 0; x < f.size[0]; ++x)
        for (const Vec3& site : {Vec3(0, 0, 0), Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5), Vec3(0.5, 0.5, 0)}) {
          const Vec3 at = (Vec3(x, y, z) + site) * edge;
          const ParticleType type = type_of(at.x());
          const std::pair<double, double> key{type.material,
                                              type.velocity.x() + (type.pd || type.imposed[0] ? 1 : 0)};
          size_t t = 0;
          while (t < keys.size() && keys[t] != key) ++t;
          if (t == keys.size()) keys.push_back(key), rule.types.push_back(type);
          scene.body.type.push_back(static_cast<uint8_t>(t));
          const Vec3 jitter = any(), speed = any();
          scene.body.x.push_back(at + f.jitter * jitter);
          scene.body.v.push_back(f.speed * speed);
        }
  if (f.flat) flatten(scene);
  return scene;
}

inline Setup block(const Features& f, const Arch& arch = {}) { return make_setup(block_scene(f), arch); }

}  // namespace cuboct::test
