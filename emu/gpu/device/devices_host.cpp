// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <vector>

#include "emu/gpu/bench/bench.h"
#include "emu/gpu/device/sharing.h"

namespace cuboct::gpu {

// The host stands for any number of devices: their memory is one.
std::vector<Device> find_devices(std::string*) {
  const auto free =
      static_cast<uint64_t>(sysconf(_SC_AVPHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  std::vector<Device> devices;
  constexpr uint64_t kBlockMemory = 227 * 1024;  // an H100's
  for (int k = 0; k < 8; ++k) devices.push_back({k, "host", "", 1, free, free, kBlockMemory});
  return devices;
}

void share_devices(bool) { Sharing::all().begin(); }

double copy_bandwidth(int) {
  using Clock = std::chrono::steady_clock;
  std::vector<char> from(size_t{1} << 26, 1), to(from.size());
  double best = 0;
  for (int k = 0; k < 3; ++k) {
    const auto begin = Clock::now();
    std::memcpy(to.data(), from.data(), from.size());
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    best = std::max(best, 2.0 * static_cast<double>(from.size()) / seconds);
  }
  return best;
}

}  // namespace cuboct::gpu
