// SPDX-License-Identifier: MIT
#include <algorithm>

#include "emu/gpu/run.h"

namespace cuboct::gpu {

std::vector<uint64_t> watch_steps(const std::vector<uint64_t>& probes, uint64_t particles) {
  constexpr uint64_t kParticles = 50'000'000, kFewest = 5;
  const uint64_t most = std::max(kFewest, kParticles / std::max<uint64_t>(particles, 1));
  const uint64_t every = (probes.size() + most - 1) / most;
  std::vector<uint64_t> looks;
  for (size_t k = 0; k < probes.size(); k += every) looks.push_back(probes[k]);
  return looks;
}

}  // namespace cuboct::gpu
