// SPDX-License-Identifier: MIT
// traffic_case NAME STEPS: what the memories of a test case's machine read and write in so many steps, by the
// timing model: a line per memory with its name, reads and writes. Prints the number of its particles first.
#include <cstdio>
#include <string>
#include <vector>

#include "emu/lattice/engine.h"
#include "emu/timing/kicks.h"
#include "emu/timing/timing.h"
#include "hw/cost/memory_traffic.h"
#include "tests/support/cases.h"

int main(int argc, char** argv) {
  using namespace cuboct;
  if (argc != 3) {
    std::fprintf(stderr, "usage: traffic_case NAME STEPS\n");
    return 2;
  }
  const test::Case c = test::make_case(argv[1]);
  const Plan& plan = c.setup.plan;
  emu::LatticeEngine engine(plan, 0, plan.particles, [&](uint32_t k) { return c.setup.initial.particles[k]; },
                            {});
  emu::TimingModel timing(plan, 1);
  emu::CellSlots slots;
  emu::KickCounter kicks(plan, 1);
  std::vector<MachineEvents> events(plan.nodes());
  for (unsigned long long left = std::stoull(argv[2]); left > 0; --left) {
    engine.slots(slots);
    kicks.add(engine.state().particles, events);
    engine.step();
    timing.step(slots, engine.leaving(), {});
  }
  MachineEvents total = sum(timing.events());
  total += sum(events);
  std::printf("particles\t%u\t0\n", plan.particles);
  for (const MemoryTraffic& m : memory_traffic(plan, total))
    if (m.counted)
      std::printf("%s\t%llu\t%llu\n", m.holds.c_str(), static_cast<unsigned long long>(m.reads),
                  static_cast<unsigned long long>(m.writes));
  return 0;
}
