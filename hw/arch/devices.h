// SPDX-License-Identifier: MIT
// A machine on several devices: which nodes stand on which, and what a link between two devices costs.
// docs/reference/boards.md.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/arch/bricks.h"
#include "model/contract/lattice.h"

namespace cuboct {

// The lattice of nodes is cut into boxes of `nodes`, one for each device. A beat on a link between devices
// is seen `latency` cycles later than on a wire, and such a link takes a beat every `interval` cycles.
struct DeviceCut {
  static constexpr int kMostLatency = 4095, kMostInterval = 1024;
  Cell nodes{0, 0, 0};  // along x, y, z; 0: all are on one device
  int latency = 1;      // 1 to kMostLatency
  int interval = 1;     // 1 to kMostInterval
  bool several() const { return nodes[0] > 0; }
};

// The device of each node, by the box's number: x first, then y, then z, among boxes with a node.
struct DeviceMap {
  DeviceMap(const Lattice& lattice, const Bricks& bricks, const DeviceCut& boards);
  std::vector<uint32_t> device;  // [node]
  uint32_t devices = 0;
};

// By node, bit f: the link over face f leads to another device. Empty where all are on one.
std::vector<uint8_t> cut_links(const Lattice& lattice, const Bricks& bricks, const DeviceCut& boards);

}  // namespace cuboct
