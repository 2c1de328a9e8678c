// SPDX-License-Identifier: MIT
#include <cuda_runtime_api.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>

#include "emu/gpu/bench/bench.h"
#include "emu/gpu/device/sharing.h"

namespace cuboct::gpu {
namespace {

// Bytes of the device that nobody has: those of its pool that wait for the next one, too.
uint64_t free_bytes(int device, size_t free) {
  cudaMemPool_t pool = nullptr;
  uint64_t kept = 0, used = 0;
  if (cudaDeviceGetDefaultMemPool(&pool, device) == cudaSuccess &&
      cudaMemPoolGetAttribute(pool, cudaMemPoolAttrReservedMemCurrent, &kept) == cudaSuccess &&
      cudaMemPoolGetAttribute(pool, cudaMemPoolAttrUsedMemCurrent, &used) == cudaSuccess)
    return free + (kept - used);
  return free;
}

}  // namespace

void share_devices(bool sleeping) {
  // Streams that go through one of the driver's connections wait for one another; it has 8 unless told.
  setenv("CUDA_DEVICE_MAX_CONNECTIONS", "32", 0);
  if (sleeping) cudaSetDeviceFlags(cudaDeviceScheduleBlockingSync);
  Sharing::all().begin();
}

std::vector<Device> find_devices(std::string* why) {
  // What never changes takes a millisecond to ask, and runs that go on at once ask each.
  static std::mutex guard;
  static std::vector<Device> devices;
  const std::lock_guard lock(guard);
  if (!devices.empty()) {
    for (Device& device : devices) {
      size_t free = 0, total = 0;
      cudaSetDevice(device.ordinal);
      cudaMemGetInfo(&free, &total);
      device.free = free_bytes(device.ordinal, free);
    }
    return devices;
  }
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
    device.memory = total, device.free = free_bytes(k, free);
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
