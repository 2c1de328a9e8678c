// SPDX-License-Identifier: MIT
// What `cuboct boards` finds: ways to cut a machine into devices, each with its exact cycles.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "hw/plan/partition.h"

namespace cuboct {

// How many of a plan's nodes a device holds.
struct DeviceRoom {
  uint64_t nodes = 0;
  std::string why;  // "DSP: 52 of 156 for each"; empty where it was given
};
// Synthesises a node. Throws InputError for an unknown device or one without limits, Failed.
DeviceRoom device_room(const Plan& plan, const std::string& target);

struct CountedPartition {
  Partition partition;
  uint64_t devices = 0;    // that have a node
  double cycles = 0;       // per step, mean
  double by_latency = 0;   // of these: what links of a beat per cycle would add to one device's
  double by_interval = 0;  // ... and what their intervals add to that
};

struct BoardsFindings {
  std::string scene, arch, device;  // device: empty where its room was given
  DeviceRoom room;
  DeviceLinkKind link;
  double clock = 0;  // Hz
  uint64_t nodes = 0, particles = 0, steps = 0;
  int beat_bits = 0;
  double one_device = 0;  // cycles per step if all nodes stood on one
  std::vector<CountedPartition> rows;
  std::vector<Partition> without_lanes;

  // Of `rows`: the fewest cycles, of equals the fewest devices.
  const CountedPartition& fastest() const;
};

std::string text_of(const BoardsFindings& found);
std::string json_of(const BoardsFindings& found);
// The arch with [boards].
std::string with_boards(const std::string& arch, const std::string& path, const DeviceCut& boards);

}  // namespace cuboct
