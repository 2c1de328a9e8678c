// SPDX-License-Identifier: MIT
// Kernels of a file that was compiled while the engine runs: machine code of a device; on the host, for
// tests, a shared library. All throw std::runtime_error.
#pragma once

#include <string>
#include <vector>

#include "emu/gpu/device/device.h"

#ifdef CUBOCT_GPU_HOST
#include <dlfcn.h>
#endif

namespace cuboct::gpu {

#ifdef CUBOCT_GPU_HOST

inline std::string architecture_of(const Stream&) { return "host"; }

class LoadedKernels {
 public:
  LoadedKernels(Stream&, const std::string& path, const std::vector<std::string>& names)
      : library_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (!library_) throw std::runtime_error(dlerror());
    for (const std::string& name : names) kernels_.push_back(dlsym(library_, name.c_str()));
  }
  LoadedKernels(const LoadedKernels&) = delete;
  LoadedKernels& operator=(const LoadedKernels&) = delete;
  ~LoadedKernels() { dlclose(library_); }

  // A thread for each index below `count`, with a copy of `frame`.
  template <class Frame>
  void launch(Stream& stream, size_t kernel, uint32_t count, int, const Frame& frame) const {
    const auto run = reinterpret_cast<void (*)(uint32_t, const Frame&)>(kernels_[kernel]);
    stream.later([=] { run(count, frame); });
  }

 private:
  void* library_;
  std::vector<void*> kernels_;
};

#else

inline std::string architecture_of(const Stream& stream) {
  int major = 0, minor = 0;
  check(cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, stream.device()), "device");
  check(cudaDeviceGetAttribute(&minor, cudaDevAttrComputeCapabilityMinor, stream.device()), "device");
  return "sm_" + std::to_string(major) + std::to_string(minor);
}

class LoadedKernels {
 public:
  LoadedKernels(Stream& stream, const std::string& path, const std::vector<std::string>& names) {
    stream.activate();
    check(cudaLibraryLoadFromFile(&library_, path.c_str(), nullptr, nullptr, 0, nullptr, nullptr, 0),
          "load compiled kernels");
    for (const std::string& name : names) {
      kernels_.emplace_back();
      const cudaError_t error = cudaLibraryGetKernel(&kernels_.back(), library_, name.c_str());
      if (error != cudaSuccess) cudaLibraryUnload(library_);
      check(error, "find a compiled kernel");
    }
  }
  LoadedKernels(const LoadedKernels&) = delete;
  LoadedKernels& operator=(const LoadedKernels&) = delete;
  ~LoadedKernels() { cudaLibraryUnload(library_); }

  // A thread for each index below `count`, with a copy of `frame`.
  template <class Frame>
  void launch(Stream& stream, size_t kernel, uint32_t count, int block, const Frame& frame) const {
    if (count == 0) return;
    stream.activate();
    void* arguments[] = {&count, const_cast<Frame*>(&frame)};
    check(cudaLaunchKernel(reinterpret_cast<const void*>(kernels_[kernel]), blocks_for(count, block), block,
                           arguments, 0, stream.get()),
          "start a compiled kernel");
  }

 private:
  cudaLibrary_t library_ = nullptr;
  std::vector<cudaKernel_t> kernels_;
};

#endif

}  // namespace cuboct::gpu
