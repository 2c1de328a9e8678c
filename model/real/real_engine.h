// SPDX-License-Identifier: MIT
// The state and the steps of the real-number engine, in one precision.
#pragma once

#include <memory>
#include <vector>

#include "model/real/near_list.h"
#include "model/real/reference.h"

namespace cuboct {

class RealEngine {
 public:
  virtual ~RealEngine() = default;
  // The step's number is for errors.
  virtual void step(uint64_t number) = 0;
  // x, v and u by id.
  virtual void read(Body& body) const = 0;
  // The state becomes that of `body`, with as many particles of the same types.
  virtual void place(const Body& body) = 0;
  virtual std::vector<Vec3> forces() const = 0;
  virtual double largest_speed() const = 0;  // m/s, along an axis, since the start
  virtual const NearList& list() const = 0;
  virtual uint64_t lists_made() const = 0;
};

// Sizes and types of the body fit the rule.
std::unique_ptr<RealEngine> make_real_engine(const Rule& rule, const Body& body, const Periodic& periodic,
                                             const RealOptions& options);

}  // namespace cuboct
