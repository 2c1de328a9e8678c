// SPDX-License-Identifier: MIT
#include "hw/arch/devices.h"

#include <algorithm>
#include <map>

#include "hw/arch/cell_box.h"

namespace cuboct {

DeviceMap::DeviceMap(const Lattice& lattice, const Bricks& bricks, const DeviceCut& boards)
    : device(bricks.size()) {
  if (bricks.size() == 0) return;
  Cell low = bricks.low(lattice, 0);
  for (uint32_t n = 1; n < bricks.size(); ++n)
    for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], bricks.low(lattice, n)[a]);
  std::map<Cell, std::vector<uint32_t>> boxes;  // by z, y, x
  for (uint32_t n = 0; n < bricks.size(); ++n) {
    Cell box{0, 0, 0};
    for (int a = 0; a < 3 && boards.several(); ++a)
      box[2 - a] = (bricks.low(lattice, n)[a] - low[a]) / (bricks.shape()[a] * boards.nodes[a]);
    boxes[box].push_back(n);
  }
  for (const auto& [box, nodes] : boxes) {
    for (const uint32_t n : nodes) device[n] = devices;
    ++devices;
  }
}

std::vector<uint8_t> cut_links(const Lattice& lattice, const Bricks& bricks, const DeviceCut& boards) {
  if (!boards.several()) return {};
  const DeviceMap map(lattice, bricks, boards);
  std::vector<uint8_t> cut(bricks.size());
  for (uint32_t n = 0; n < bricks.size(); ++n)
    for (int f = 0; f < kFaces; ++f)
      if (const uint32_t other = bricks.neighbour(lattice, n, f);
          other != kNoNode && map.device[other] != map.device[n])
        cut[n] = static_cast<uint8_t>(cut[n] | 1u << f);
  return cut;
}

}  // namespace cuboct
