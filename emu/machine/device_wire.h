// SPDX-License-Identifier: MIT
// One direction of a link between devices, clocked: it takes a beat every `interval` cycles and shows it
// `latency` cycles later. docs/reference/boards.md. Knows nothing of SystemC.
#pragma once

#include <deque>
#include <utility>

#include "emu/machine/node_model.h"
#include "hw/plan/plan.h"

namespace cuboct::emu {

class DeviceWire {
 public:
  explicit DeviceWire(const DeviceCut& boards)
      : latency_(static_cast<uint64_t>(boards.latency)), interval_(static_cast<uint64_t>(boards.interval)) {}
  // Whether the sender sees ready in a cycle.
  bool ready(uint64_t cycle) const { return cycle >= free_; }
  // A cycle in which the sender shows a beat and sees ready.
  void take(uint64_t cycle, const Beat& beat) {
    on_the_way_.emplace_back(cycle + latency_, beat);
    free_ = cycle + interval_;
  }
  // What has come by a cycle and was not read yet, or null.
  const Beat* come(uint64_t cycle) const {
    return on_the_way_.empty() || on_the_way_.front().first > cycle ? nullptr : &on_the_way_.front().second;
  }
  void read() { on_the_way_.pop_front(); }

 private:
  const uint64_t latency_, interval_;
  uint64_t free_ = 0;  // the first cycle that can take a beat
  std::deque<std::pair<uint64_t, Beat>> on_the_way_;
};

}  // namespace cuboct::emu
