// SPDX-License-Identifier: MIT
// Ways to cut a machine into devices: boxes of nodes that a device has room and lanes for.
// docs/reference/boards.md, "Partitions".
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hw/arch/device_link.h"
#include "hw/arch/devices.h"
#include "hw/plan/plan.h"

namespace cuboct {

// What stands on a device inside of the machine, with a neighbour at each face along which there are several.
struct Partition {
  DeviceCut boards;       // box, latency and interval
  Cell devices{1, 1, 1};  // along x, y, z
  Cell links{0, 0, 0};    // that cross a face, one way, by its axis; 0 where no other device is
  Cell faces{0, 0, 0};    // of a device that they cross, by axis: 1 where there are two devices in a row
  uint64_t lanes = 0;     // that the faces need at this interval, both ways

  uint64_t count() const {
    return uint64_t{static_cast<uint32_t>(devices[0])} * static_cast<uint32_t>(devices[1]) *
           static_cast<uint32_t>(devices[2]);
  }
};

// Of a link's beat on a lane: payload, end, and whether there is one.
int board_beat_bits(const Plan& plan);

// Nodes along the axes of the smallest box that holds the machine.
Cell node_grid(const Plan& plan);

// The partition into boxes of `nodes`: each link crosses a face over its share of the face's lanes, and takes
// a beat in the fewest cycles with which all faces' lanes are no more than the kind has. Where they are not
// enough at any interval, `lanes` are those of the longest. Throws InputError where the latency is out of
// range.
Partition partition_of(const Plan& plan, const DeviceLinkKind& kind, double clock, const Cell& nodes);
inline bool enough_lanes(const Partition& p, const DeviceLinkKind& kind) { return p.lanes <= kind.lanes(); }

// For each power of two of devices, from the fewest that have room, the partition that should lose least to
// its links; no two with as many devices. `room`: nodes that a device holds. Those without enough lanes come
// where no other with so few devices does.
std::vector<Partition> partitions(const Plan& plan, const DeviceLinkKind& kind, double clock, uint64_t room,
                                  double particles_per_node);

}  // namespace cuboct
