// SPDX-License-Identifier: MIT
// Where methods fail: detectors that look at a run while it goes, in any engine, and name what went wrong
// with step, place and number. docs/reference/failures.md has a section per failure. The faults of the fixed
// engines (model/error.h: a velocity that saturates, a full node) stop a run by themselves; what stands here
// is what a run survives and is wrong all the same.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/fixed_rule.h"
#include "model/lattice.h"
#include "model/scene.h"
#include "model/state.h"

namespace cuboct {

enum class Failure : uint8_t {
  time_step,        // velocities flip from step to step: dt is beyond the stability limit
  damping,          // the same, and the damping's share of the limit is the larger
  stiff_hold,       // the same, at a particle that a PD controller holds or moves, by its gains
  force_jump,       // the law's force jumps at its cutoff: energy drifts in first order of dt
  tunnelling,       // a pair inside the law's core, where the force rolls off, or through each other
  constraint_work,  // imposed positions feed in more energy than the body takes up as strain
  heating,          // a run that should keep its energy gains it: table seams, too few value bits
  creep,            // a body at rest moves by itself
  far_origin,       // float32 positions whose spacing is not small beside the pitch
  order,            // sums whose bits depend on the order: two runs differ
};
const char* to_string(Failure failure);  // as in docs: "time step", ...

struct Finding {
  Failure failure = Failure::time_step;
  uint64_t step = 0;
  std::optional<uint32_t> particle;  // where the failure has one
  Vec3 place = Vec3::Zero();         // m
  double number = 0, limit = 0;      // what was measured, and what it may be; same unit
  std::string text;                  // one line: "step 120: ... particle 17 at (...) m: ... 1.3 > 1"
};

// What detectors see of a run at one step, in SI units, ordered by id.
struct Moment {
  uint64_t step = 0;
  std::span<const Vec3> x;       // m
  std::span<const Vec3> v;       // m/s, before the kick of this step
  std::span<const Vec3> v_next;  // m/s, after it
  std::span<const Vec3> force;   // N, of the pairs
};

class Watch {
 public:
  // What can be told before the first step (a law that jumps, ...) is found here. Keeps a reference to
  // `scene`.
  explicit Watch(const Scene& scene);

  void see(const Moment& moment);
  // A state of a fixed engine; `kicks`: summed_kicks of it.
  void see(const FixedRule& rule, const Lattice& lattice, const Vec3& origin, const State& state,
           const std::vector<Int3>& kicks);

  // The first finding of each failure, in the order in which they came.
  const std::vector<Finding>& findings() const { return findings_; }

 private:
  const Scene& scene_;
  std::vector<Finding> findings_;
};

}  // namespace cuboct
