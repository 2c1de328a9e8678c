// SPDX-License-Identifier: MIT
// What machines of one scene do in the steps that are counted. Machines that differ in nothing that a bit
// depends on share one run: the timing model (emu/timing/timing.h) of each looks at the same particles.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hw/cost/cycles.h"
#include "hw/cost/events.h"
#include "hw/plan/setup.h"
#include "study/sweep/settings.h"

namespace cuboct::study {

// Where the cycles of a step go, in the node that waits least; they add up to all. `force` is what is left of
// FORCE once the last exchange is over; waiting for neighbours is of the phase in which it happens.
enum class StepPart : uint8_t { exchange, force, update, migrate };
inline constexpr size_t kStepParts = 4;
// What a node could be waiting for, as the cycles per step that the busiest node needs of it at full use.
//   lanes: candidates over streamers; pipes: pairs over pipes, times the cycles between two issues;
//   links: beats over the two faces that an exchange serves at a time; memory: particles that UPDATE and
//   SCAN walk, one a cycle.
enum class Demand : uint8_t { lanes, pipes, links, memory };
inline constexpr size_t kDemands = 4;

struct MachineCounts {
  uint64_t steps = 0;    // that were counted; fewer than asked where the next one breaks something
  uint64_t cycles = 0;   // of all of them
  uint64_t most = 0;     // of one step
  MachineEvents events;  // of all nodes
  std::array<double, kStepParts> parts{};  // cycles per step
  std::array<double, kDemands> demands{};  // cycles per step

  double mean() const { return static_cast<double>(cycles) / static_cast<double>(steps); }
  bool operator==(const MachineCounts&) const = default;
};
// One line of JSON, and back. Throws nlohmann's exception where a count is missing.
std::string counts_json(const MachineCounts& counts);

// A scene as its machines see it: all that does not depend on lanes, pipes, links, bricks, multipliers,
// memories, queues, on when halos are used and whether exchange and filter overlap.
class SharedSetup {
 public:
  // Of `settings` with these keys at their defaults. Throws InputError where that makes no plan.
  SharedSetup(const Base& base, const Settings& settings);
  // The plan of an arch of the same scene: machine_setup's own, to the hash. Throws InputError.
  Plan plan_of(const Arch& arch) const;
  ExpectedCycles expected(const Plan& plan) const;
  const State& initial() const { return setup_.initial; }
  const Plan& plan() const { return setup_.plan; }
  const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
  Setup setup_;
  PairCensus census_;
};
// The settings without the keys that SharedSetup leaves at their defaults: what a bit depends on.
Settings of_bits(Settings settings);

// Of each plan, of one shared setup; nothing where the first step breaks a width or a capacity. With an
// interrupt (model/base/interrupt.h) what was counted so far.
std::vector<std::optional<MachineCounts>> count_machines(const SharedSetup& shared,
                                                         const std::vector<Plan>& plans, uint64_t steps);

// The demand that binds: "lanes", "pipes", "links", "memory"; "latency" where the greatest is less than half
// of the step.
std::string bound_of(const MachineCounts& counts);
const char* name_of(StepPart part);
const char* name_of(Demand demand);

}  // namespace cuboct::study
