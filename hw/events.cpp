// SPDX-License-Identifier: MIT
#include "hw/events.h"

namespace cuboct {
namespace {

constexpr std::array<NamedEvent, 15> kNames{{{"steps", &MachineEvents::steps},
                                             {"updates", &MachineEvents::updates},
                                             {"candidates", &MachineEvents::candidates},
                                             {"queue_entries", &MachineEvents::entries},
                                             {"issue_cycles", &MachineEvents::issues},
                                             {"pairs_issued", &MachineEvents::pairs},
                                             {"queue_stalls", &MachineEvents::queue_stalls},
                                             {"relayed", &MachineEvents::relayed},
                                             {"halos", &MachineEvents::halos},
                                             {"tested", &MachineEvents::tested},
                                             {"moved", &MachineEvents::moved},
                                             {"left", &MachineEvents::left},
                                             {"inner", &MachineEvents::inner},
                                             {"scanned", &MachineEvents::scanned},
                                             {"link_beats", &MachineEvents::beats}}};

}  // namespace

std::span<const NamedEvent> event_names() { return kNames; }

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
