// SPDX-License-Identifier: MIT
// The state and the steps of the real-number engine, in one precision.
#pragma once

#include <memory>
#include <vector>

#include "model/real/near_list.h"
#include "model/real/reference.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {

class RealEngine {
 public:
  virtual ~RealEngine() = default;
  // The step's number is for errors.
  virtual void step(uint64_t number) = 0;
  // x, v and u by id.
  virtual void read(Body& body) const = 0;
  // The state becomes that of `body`, with as many particles of the same types, after so many steps.
  virtual void place(const Body& body, uint64_t step) = 0;
  virtual std::vector<Vec3> forces() const = 0;
  // The bonds of a rule of rounds give way as they do in a step, without one.
  virtual void give_way() {}
  virtual double largest_speed() const = 0;  // m/s, along an axis, since the start
  virtual const NearList& list() const = 0;  // of pairs: not of a rule of several rounds
  virtual uint64_t lists_made() const = 0;
  // Of a rule of several rounds, at the state of now, or RoundsError as of forces(); null: pairs.
  virtual const RoundsTerms* terms() const { return nullptr; }
  // The same without the work of its rounds: right in what goes on from step to step.
  virtual const RoundsTerms* kept_terms() const { return nullptr; }
  // What a checkpoint keeps besides x, v and u.
  virtual std::vector<uint64_t> memory() const { return {}; }
  virtual void recall(const std::vector<uint64_t>&) {}
};

// Sizes and types of the body fit the rule.
std::unique_ptr<RealEngine> make_real_engine(const Rule& rule, const Body& body, const Periodic& periodic,
                                             const RealOptions& options);

}  // namespace cuboct
