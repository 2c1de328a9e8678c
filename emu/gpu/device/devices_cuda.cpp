// SPDX-License-Identifier: MIT
#include <cuda_runtime_api.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "emu/gpu/bench/bench.h"

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
    device.block_memory = properties.sharedMemPerBlockOptin;
    devices.push_back(std::move(device));
  }
  return devices;
}

namespace {

void check(cudaError_t error, const char* what) {
  if (error != cudaSuccess)
    throw std::runtime_error(std::string("CUDA: ") + what + ": " + cudaGetErrorString(error));
}

}  // namespace

double copy_bandwidth(int device) {
  check(cudaSetDevice(device), "choose a device");
  size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total), "memory");
  const size_t bytes = std::min<size_t>(size_t{1} << 30, free / 4);
  void *from = nullptr, *to = nullptr;
  cudaEvent_t begin, end;
  check(cudaMalloc(&from, bytes), "allocate device memory");
  check(cudaMalloc(&to, bytes), "allocate device memory");
  check(cudaEventCreate(&begin), "make an event");
  check(cudaEventCreate(&end), "make an event");
  check(cudaMemset(from, 1, bytes), "clear device memory");
  double best = 0;
  for (int k = 0; k < 8; ++k) {
    check(cudaEventRecord(begin), "record an event");
    check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice), "copy");
    check(cudaEventRecord(end), "record an event");
    check(cudaEventSynchronize(end), "copy");
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, begin, end), "time");
    best = std::max(best, 2.0 * static_cast<double>(bytes) / (1e-3 * static_cast<double>(milliseconds)));
  }
  cudaEventDestroy(begin), cudaEventDestroy(end);
  cudaFree(from), cudaFree(to);
  return best;
}

}  // namespace cuboct::gpu
