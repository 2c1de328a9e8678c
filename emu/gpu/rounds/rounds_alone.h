// SPDX-License-Identifier: MIT
// What a kernel of rounds needs of its machine, for where it is compiled while the engine runs: CUDA's
// compiler in a library, which has no headers of the host's; or, in tests, the host's own.
#pragma once

#include <cstddef>
#include <cstdint>

#ifdef __CUDACC__
#define CUBOCT_DEVICE __device__
#define CUBOCT_UNROLL _Pragma("unroll")
#else
#define CUBOCT_DEVICE
#define CUBOCT_UNROLL
#endif

namespace cuboct::gpu {

#ifdef __CUDACC__
// As in emu/gpu/device/device_cuda.h: several devices see these.
CUBOCT_DEVICE inline uint32_t atomic_add(uint32_t* at, uint32_t value) { return atomicAdd_system(at, value); }
CUBOCT_DEVICE inline void atomic_min(uint32_t* at, uint32_t value) { atomicMin_system(at, value); }
#else
inline uint32_t atomic_add(uint32_t* at, uint32_t value) { return (*at += value) - value; }
inline void atomic_min(uint32_t* at, uint32_t value) { *at = *at < value ? *at : value; }
#endif

}  // namespace cuboct::gpu

#ifdef __CUDACC__
#define CUBOCT_ROUND(name, Graphs)                                                         \
  extern "C" __global__ void __launch_bounds__(256)                                        \
      name(uint32_t count, const __grid_constant__ cuboct::gpu::RoundsStep<Graphs> step) { \
    const uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;                              \
    if (i < count) step(i, {});                                                            \
  }
#else
#define CUBOCT_ROUND(name, Graphs)                                              \
  extern "C" void name(uint32_t count, const cuboct::gpu::RoundsFrame& frame) { \
    const cuboct::gpu::RoundsStep<Graphs> step{frame, {}};                      \
    for (uint32_t i = 0; i < count; ++i) step(i, {});                           \
  }
#endif
