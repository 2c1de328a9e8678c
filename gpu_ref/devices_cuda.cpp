// SPDX-License-Identifier: MIT
#include <cuda_runtime_api.h>
#include <dlfcn.h>

#include <array>

#include "gpu_ref/engine.h"

namespace cuboct::gpu {

std::vector<Device> find_devices(std::string* why) {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  if (error != cudaSuccess || count == 0) {
    // CUDA calls a driver that is not there too old.
    void* driver = dlopen("libcuda.so.1", RTLD_LAZY);
    if (why)
      *why = !driver                ? "no driver (libcuda.so.1)"
             : error == cudaSuccess ? "there is none"
                                    : cudaGetErrorString(error);
    if (driver) dlclose(driver);
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
