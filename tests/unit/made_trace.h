// SPDX-License-Identifier: MIT
// A small trace with something in each field: two nodes, three particles, two steps and a stop.
#pragma once

#include "model/trace/trace.h"

namespace cuboct {

inline State made_state(uint64_t step) {
  const auto s = static_cast<int64_t>(step);
  State state{step, {}};
  state.particles.push_back({0, 0, 0, {10 + s, 20, 30}, {1, -2, 3}, {}});
  state.particles.push_back({1, 1, 0, {40, 50 + s, 60}, {-4, 5, -6}, {7, -8, 9}});
  state.particles.push_back({5, 0, 1, {70, 80, 90 + s}, {-1000 * s, 1, int64_t{1} << 40}, {}});
  return state;
}

inline Trace made_trace() {
  Trace trace;
  trace.engine = "golden";
  trace.plan_hash = 0xfedcba9876543210u;
  trace.nodes = 2;
  trace.state_hash = {1, ~uint64_t{0}, 3};
  trace.frames = {made_state(0), made_state(2)};
  // Not in alphabetical order: the order must survive.
  trace.curves = {{"pull.strain", "1", {0, 1, 2}, {0, 0.5, 1e-300}},
                  {"grip.force_x", "N", {0, 2}, {0, -1.25}}};
  for (uint64_t step = 0; step < 2; ++step)
    for (uint64_t node = 0; node < 2; ++node)
      for (uint64_t phase = 0; phase < kPhases; ++phase)
        trace.cycles.push_back({1000 * step + 100 * phase + node, 1000 * step + 100 * phase + 9 + node});
  trace.stop =
      StopReason{Fault::velocity, 2, 1, 5, -(int64_t{1} << 40), "step 2, cell 1 (1 0 0), particle 5"};
  trace.seconds = 0.25;
  trace.counters = {{"pairs_issued", 12}, {"stalls", 0.5}};
  trace.bodies = {{0,
                   {{1, 2, 3}, {4, 5, 6}},
                   {{-1, 0.1, 1e-300}, {7, 8, 9}},
                   {{0, 1, 0}, {0, -1, 0}},
                   {{0, 0, 0}, {0.5, 0, 0}}},
                  {2,
                   {{1.5, 2, 3}, {4, 5, -6}},
                   {{-1, 0.1, 2}, {7, 8.5, 9}},
                   {{3, 0, 0}, {-3, 0, 1e9}},
                   {{1e-9, 0, 0}, {0, 0, 2}}}};
  trace.bonds = {7, ~uint64_t{0}};
  trace.reached = Reached{"grip.force_x", "beyond", 2, -0.5, 0.25};
  trace.notes = {{"precision", "float"}, {"device 0", "a device, of some name"}, {"empty", ""}};
  trace.watched = 2;
  trace.findings = {{Failure::stiff_hold, 1, std::nullopt, Vec3::Zero(), 4.5, 4, "step 1: stiff hold: ..."},
                    {Failure::far_origin, 2, 5, {0.5, -1, 2}, 3, 1, "step 2: far origin: particle 5 at ..."}};
  return trace;
}

}  // namespace cuboct
