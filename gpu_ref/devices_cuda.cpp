// SPDX-License-Identifier: MIT
#include <cuda_runtime_api.h>

#include <array>

#include "gpu_ref/engine.h"

namespace cuboct::gpu {

std::vector<Device> find_devices(std::string* why) {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  if (error != cudaSuccess || count == 0) {
    if (why) *why = error == cudaSuccess ? "there is none" : cudaGetErrorString(error);
    return {};
  }
  std::vector<Device> devices;
  for (int k = 0; k < count; ++k) {
    Device device;
    device.ordinal = k;
    cudaDeviceProp properties;
    if (cudaGetDeviceProperties(&properties, k) != cudaSuccess) continue;
    device.name = properties.name;
    device.multiprocessors = properties.multiProcessorCount;
    std::array<char, 32> bus{};
    cudaDeviceGetPCIBusId(bus.data(), static_cast<int>(bus.size()), k);
    device.bus = bus.data();
    size_t free = 0, total = 0;
    cudaSetDevice(k);
    cudaMemGetInfo(&free, &total);
    device.memory = total, device.free = free;
    devices.push_back(std::move(device));
  }
  return devices;
}

}  // namespace cuboct::gpu
