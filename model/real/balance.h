// SPDX-License-Identifier: MIT
// A body at rest between its constraints, in doubles: the forces on its free particles, and the way to where
// they vanish.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "model/base/fire.h"
#include "model/real/reference.h"

namespace cuboct {

// What is left of the forces of a body at rest, and what it carries. The forces that two ends of a body
// carry, and its weight, sum up to zero but for `residual` at most: what inertia takes in a run of motion.
struct Unbalance {
  double residual = 0;  // N, sum of the magnitudes of the forces on free particles
  double load =
      0;  // N, the largest total force on the particles of one type that is held, moved, heavy or pulled;
          // of a box that deforms at least the largest force through one of its faces so far
  double least = 0;  // N, a residual that is rounding
  bool within(double tolerance) const { return residual <= tolerance * load || residual <= least; }
  double share() const { return load > 0 ? residual / load : 0; }
};

// Velocities are 0, and nothing damps. Imposed axes stay, or go where go_on() takes them; PD controllers pull
// with kp alone.
class Balance {
 public:
  // As of Reference; the rule and the types of the body count, and its x and u.
  Balance(const Rule& rule, const Body& body, const Periodic& periodic, int threads);

  const Body& body() const { return body_; }
  const Reference& reference() const { return *reference_; }

  // N, on free axes: pairs, controllers and gravity. 0 on imposed ones.
  const std::vector<Vec3>& forces();
  // Of the last forces that were evaluated.
  Unbalance unbalance() const;

  // Whether gravity and the forces of pulled constraints act: they do at first.
  void load(bool acts) { loaded_ = acts; }

  // What is imposed moves on by its velocity for `time` s, anchors of controllers too. The free particles go
  // where they went the last time, if that leaves smaller forces: two evaluations.
  void go_on(double time);
  // The box becomes this one, and all particles and anchors go with it: a load of its own, which go_on() then
  // begins with.
  void stretch(const Periodic& box);
  // What the next load step depends on besides the body: where the last one began, and the anchors of
  // controllers; by particle, empty where there are none.
  struct Memory {
    double stiffness = 0;              // N/m, of the stiffest site at the start
    std::vector<Vec3> before, anchor;  // m
    double box_load = 0;               // N, the largest that the box has carried
  };
  Memory memory() const { return {stiffness_, before_, anchor_, box_load_}; }
  void recall(Memory memory);
  // FIRE until `small` says that the forces are. Bonds that break do so at rest: those that it stretches too
  // far, all at once, and the body relaxes again until the forces stay small. What follows depends on the
  // body and on memory() alone, to the last bit: lists of pairs are made anew.
  FireResult relax(const std::function<bool(const std::vector<Vec3>& forces)>& small, uint64_t most);

 private:
  void make_lists();
  void remember_step();
  void place(const Eigen::VectorXd& x);
  double largest_force() const;

  Rule rule_;
  Body body_;
  Periodic periodic_;
  int threads_;
  bool loaded_ = true;
  std::optional<Reference> reference_;
  double stiffness_;           // N/m, of the stiffest site
  double box_load_ = 0;        // N, as in Memory
  std::vector<Vec3> anchor_;   // m; empty unless a type has a controller
  std::vector<Vec3> carried_;  // N, of pairs, by id
  std::vector<Vec3> free_;     // N
  std::vector<Vec3>
      last_step_;             // m, of the free particles in the last go_on() and what followed; empty: none
  std::vector<Vec3> before_;  // m, where the last go_on() began
  bool remembered_ = false;   // last_step_ is that of the step that begins
};

}  // namespace cuboct
