// SPDX-License-Identifier: MIT
#include "hw/cost/events.h"

namespace cuboct {
namespace {

constexpr std::array<NamedEvent, 25> kNames{{{"steps", &MachineEvents::steps},
                                             {"updates", &MachineEvents::updates},
                                             {"candidates", &MachineEvents::candidates},
                                             {"candidates_x", &MachineEvents::candidates_x},
                                             {"candidates_y", &MachineEvents::candidates_y},
                                             {"candidates_z", &MachineEvents::candidates_z},
                                             {"queue_entries", &MachineEvents::entries},
                                             {"issue_cycles", &MachineEvents::issues},
                                             {"pairs_issued", &MachineEvents::pairs},
                                             {"pairs_inside", &MachineEvents::kicks},
                                             {"queue_stalls", &MachineEvents::queue_stalls},
                                             {"relayed", &MachineEvents::relayed},
                                             {"relayed_own", &MachineEvents::relayed_own},
                                             {"halos_x", &MachineEvents::halos_x},
                                             {"halos_y", &MachineEvents::halos_y},
                                             {"halos_z", &MachineEvents::halos_z},
                                             {"tested", &MachineEvents::tested},
                                             {"culled_x", &MachineEvents::culled_x},
                                             {"culled_y", &MachineEvents::culled_y},
                                             {"culled_z", &MachineEvents::culled_z},
                                             {"moved", &MachineEvents::moved},
                                             {"left", &MachineEvents::left},
                                             {"inner", &MachineEvents::inner},
                                             {"scanned", &MachineEvents::scanned},
                                             {"link_beats", &MachineEvents::beats}}};

}  // namespace

std::span<const NamedEvent> event_names() { return kNames; }

uint64_t& halos_along(MachineEvents& events, int axis) {
  return axis == 0 ? events.halos_x : axis == 1 ? events.halos_y : events.halos_z;
}

uint64_t& candidates_along(MachineEvents& events, int axis) {
  return axis == 0 ? events.candidates_x : axis == 1 ? events.candidates_y : events.candidates_z;
}

uint64_t& culled_along(MachineEvents& events, int axis) {
  return axis == 0 ? events.culled_x : axis == 1 ? events.culled_y : events.culled_z;
}

MachineEvents& MachineEvents::operator+=(const MachineEvents& other) {
  for (const auto& [name, count] : kNames) this->*count += other.*count;
  for (size_t p = 0; p < phase_cycles.size(); ++p) phase_cycles[p] += other.phase_cycles[p];
  return *this;
}

MachineEvents sum(std::span<const MachineEvents> nodes) {
  MachineEvents total;
  for (const MachineEvents& node : nodes) total += node;
  return total;
}

}  // namespace cuboct
