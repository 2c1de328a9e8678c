// SPDX-License-Identifier: MIT
// emu/gpu/device/device.h on CUDA.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <cstring>
#include <cub/device/device_scan.cuh>
#include <stdexcept>
#include <string>
#include <vector>

#include "emu/gpu/device/sharing.h"

namespace cuboct::gpu {

inline constexpr bool kHasGraphs = true;

inline void check(cudaError_t error, const char* what) {
  if (error != cudaSuccess)
    throw std::runtime_error(std::string("CUDA: ") + what + ": " + cudaGetErrorString(error));
}

class Event {
 public:
  Event() = default;
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  ~Event() {
    if (event_) cudaEventDestroy(event_);
  }
  // Made on the device that first records it.
  cudaEvent_t make() {
    if (!event_) check(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "make an event");
    return event_;
  }
  cudaEvent_t get() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
};

class Stream {
 public:
  // Kernels of an urgent stream go first where both wait for the device.
  explicit Stream(int device = 0, bool urgent = false) : device_(device) {
    activate();
    int least = 0, greatest = 0;
    check(cudaDeviceGetStreamPriorityRange(&least, &greatest), "make a stream");
    check(cudaStreamCreateWithPriority(&stream_, cudaStreamNonBlocking, urgent ? greatest : least),
          "make a stream");
    check(cudaDeviceGetAttribute(&multiprocessors_, cudaDevAttrMultiProcessorCount, device), "device");
    // What sums need beside is asked for again soon: the pool would give it back at each wait for the host.
    cudaMemPool_t pool = nullptr;
    uint64_t all = UINT64_MAX;
    check(cudaDeviceGetDefaultMemPool(&pool, device), "device");
    check(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &all), "device");
    own().push_back(this);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() {
    std::erase(own(), this);
    cudaStreamDestroy(stream_);
  }
  // Those that this thread has made.
  static std::vector<const Stream*>& own() {
    thread_local std::vector<const Stream*> streams;
    return streams;
  }
  int device() const { return device_; }
  int multiprocessors() const { return multiprocessors_; }
  void activate() const { check(cudaSetDevice(device_), "choose a device"); }
  void record(Event& event) {
    activate();
    check(cudaEventRecord(event.make(), stream_), "record an event");
  }
  void wait(const Event& event) {
    if (event.get()) check(cudaStreamWaitEvent(stream_, event.get()), "wait for an event");
  }
  void synchronize() { check(cudaStreamSynchronize(stream_), "run on the device"); }
  cudaStream_t get() const { return stream_; }

 private:
  int device_;
  int multiprocessors_ = 1;
  cudaStream_t stream_ = nullptr;
};

// What a stream was asked for between `begin` and `end`, to be launched as a whole.
class Graph {
 public:
  Graph() = default;
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;
  ~Graph() { drop(); }
  void begin(Stream& stream) {
    stream.activate();
    check(cudaStreamBeginCapture(stream.get(), cudaStreamCaptureModeThreadLocal), "begin a graph");
  }
  void end(Stream& stream) {
    drop();
    cudaGraph_t graph = nullptr;
    check(cudaStreamEndCapture(stream.get(), &graph), "end a graph");
    const cudaError_t error = cudaGraphInstantiate(&exec_, graph, 0);
    cudaGraphDestroy(graph);
    check(error, "make a graph");
  }
  void launch(Stream& stream) { check(cudaGraphLaunch(exec_, stream.get()), "launch a graph"); }
  bool ready() const { return exec_ != nullptr; }
  void drop() {
    if (exec_) cudaGraphExecDestroy(exec_);
    exec_ = nullptr;
  }

 private:
  cudaGraphExec_t exec_ = nullptr;
};

// Runs that go on at once share a pool: cudaFree would have each wait for all.
inline void* allocate(int device, size_t bytes) {
  void* memory = nullptr;
  check(cudaSetDevice(device), "choose a device");
  if (!Sharing::all().on()) {
    check(cudaMalloc(&memory, bytes), "allocate device memory");
    return memory;
  }
  check(cudaMallocAsync(&memory, bytes, cudaStreamPerThread), "allocate device memory");
  check(cudaStreamSynchronize(cudaStreamPerThread), "allocate device memory");
  return memory;
}
// Waits for what uses it: for the device, or for the streams of the run, whose thread this is.
inline void release(int device, void* memory) {
  if (!memory) return;
  cudaSetDevice(device);
  if (!Sharing::all().on()) {
    cudaFree(memory);
    return;
  }
  for (const Stream* stream : Stream::own()) cudaStreamSynchronize(stream->get());
  cudaFreeAsync(memory, cudaStreamPerThread);
}
inline void copy(Stream& stream, void* to, int to_device, const void* from, int from_device, size_t bytes) {
  check(to_device == from_device ? cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream.get())
                                 : cudaMemcpyPeerAsync(to, to_device, from, from_device, bytes, stream.get()),
        "copy between devices");
}
inline void upload(Stream& stream, void* to, const void* from, size_t bytes) {
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream.get()), "copy to the device");
  stream.synchronize();  // `from` may go
}
// Pages that stay: the driver need not copy what is little a second time.
class Landing {
 public:
  static constexpr size_t kBytes = size_t{64} * 1024;
  Landing() = default;
  Landing(const Landing&) = delete;
  Landing& operator=(const Landing&) = delete;
  ~Landing() {
    if (memory_) cudaFreeHost(memory_);
  }
  void* memory() {
    if (!memory_) check(cudaMallocHost(&memory_, kBytes), "allocate memory that devices reach");
    return memory_;
  }

 private:
  void* memory_ = nullptr;
};
inline void download(Stream& stream, void* to, const void* from, size_t bytes) {
  thread_local Landing landing;
  void* first = bytes <= Landing::kBytes ? landing.memory() : to;
  check(cudaMemcpyAsync(first, from, bytes, cudaMemcpyDeviceToHost, stream.get()), "copy from the device");
  stream.synchronize();
  if (first != to) std::memcpy(to, first, bytes);
}
inline void clear(Stream& stream, void* memory, size_t bytes) {
  stream.activate();
  check(cudaMemsetAsync(memory, 0, bytes, stream.get()), "clear device memory");
}

// Lets each of the devices write into the others' memory.
inline void share(const std::vector<int>& devices) {
  for (const int a : devices)
    for (const int b : devices) {
      if (a == b) continue;
      int can = 0;
      check(cudaDeviceCanAccessPeer(&can, a, b), "peer access");
      if (!can)
        throw std::runtime_error("CUDA: device " + std::to_string(a) +
                                 " has no access to the memory of device " + std::to_string(b));
      check(cudaSetDevice(a), "choose a device");
      const cudaError_t error = cudaDeviceEnablePeerAccess(b, 0);
      if (error == cudaErrorPeerAccessAlreadyEnabled)
        (void)cudaGetLastError();
      else
        check(error, "peer access");
    }
}

// Seen by all devices: they share counters of cells at their borders, and tell each other when to stop.
__device__ inline uint32_t atomic_add(uint32_t* at, uint32_t value) { return atomicAdd_system(at, value); }
__device__ inline void atomic_min(uint32_t* at, uint32_t value) { atomicMin_system(at, value); }

// The four numbers of a particle, in loads of 16 bytes.
template <typename T>
__device__ T load(const T* at) {
  static_assert(sizeof(T) % 16 == 0);
  T value;
  const auto* from = reinterpret_cast<const int4*>(at);
  auto* to = reinterpret_cast<int4*>(&value);
#pragma unroll
  for (size_t k = 0; k < sizeof(T) / 16; ++k) to[k] = from[k];
  return value;
}

template <typename T>
__device__ void store(T* at, const T& value) {
  static_assert(sizeof(T) % 16 == 0);
  const auto* from = reinterpret_cast<const int4*>(&value);
  auto* to = reinterpret_cast<int4*>(at);
#pragma unroll
  for (size_t k = 0; k < sizeof(T) / 16; ++k) to[k] = from[k];
}

inline constexpr int kLargestBlock = 256;

template <class F>
__global__ void __launch_bounds__(kLargestBlock)
    each_kernel(uint32_t begin, uint32_t end, const __grid_constant__ F f) {
  for (uint32_t i = begin + blockIdx.x * blockDim.x + threadIdx.x; i < end; i += gridDim.x * blockDim.x) f(i);
}

// Each block holds `cache` in shared memory. All its threads go on or none does, though what they are told of
// may change while they ask: those that left would leave a part of the cache unread.
template <class F>
__global__ void __launch_bounds__(kLargestBlock)
    cached_kernel(uint32_t begin, uint32_t end, const uint32_t* cache, uint32_t words,
                  const __grid_constant__ F f) {
  extern __shared__ uint4 memory[];
  if (__syncthreads_or(f.idle())) return;
  auto* here = reinterpret_cast<uint32_t*>(memory);
  for (uint32_t k = threadIdx.x; k < words; k += blockDim.x) here[k] = cache[k];
  __syncthreads();
  for (uint32_t i = begin + blockIdx.x * blockDim.x + threadIdx.x; i < end; i += gridDim.x * blockDim.x)
    f(i, here);
}

template <class F>
__global__ void __launch_bounds__(kLargestBlock)
    sum_kernel(uint32_t begin, uint32_t end, const __grid_constant__ F f, uint64_t* out) {
  if (f.idle()) return;
  unsigned long long sum = 0;
  for (uint32_t i = begin + blockIdx.x * blockDim.x + threadIdx.x; i < end; i += gridDim.x * blockDim.x)
    sum += f(i);
  for (int k = 16; k > 0; k /= 2) sum += __shfl_down_sync(0xffffffffu, sum, k);
  if (threadIdx.x % 32 == 0) atomicAdd(reinterpret_cast<unsigned long long*>(out), sum);
}

template <class F>
__global__ void __launch_bounds__(kLargestBlock)
    max_kernel(uint32_t begin, uint32_t end, const __grid_constant__ F f, uint32_t* out) {
  uint32_t most = 0;
  for (uint32_t i = begin + blockIdx.x * blockDim.x + threadIdx.x; i < end; i += gridDim.x * blockDim.x)
    most = max(most, f(i));
  most = __reduce_max_sync(0xffffffffu, most);
  if (threadIdx.x % 32 == 0) atomicMax(out, most);
}

// Where the blocks of a launch wait for each other: how many ends of steps they have come to, counted on from
// the launch, and a bit once one of them goes on no further.
struct MeetingWords {
  static constexpr uint32_t kClosed = 0x80000000u;
  uint32_t arrived;
};
class Meeting {
 public:
  explicit Meeting(int device) : device_(device) {}
  Meeting(const Meeting&) = delete;
  Meeting& operator=(const Meeting&) = delete;
  ~Meeting() { release(device_, words_); }
  // For a launch on this stream.
  MeetingWords* begin(Stream& stream) {
    if (!words_) words_ = static_cast<MeetingWords*>(allocate(device_, sizeof(MeetingWords)));
    clear(stream, words_, sizeof(MeetingWords));
    return words_;
  }

 private:
  int device_;
  MeetingWords* words_ = nullptr;
};

// A block's wait for the others at the end of step `number`, which `goes_on` says of its first thread's look
// at the step's begin. False: some block goes on no further. What any of them wrote is then seen by all.
__device__ inline bool meet(MeetingWords* words, uint32_t number, bool goes_on) {
  __shared__ bool on;
  __syncthreads();
  if (threadIdx.x == 0) {
    if (goes_on) {
      asm volatile("red.release.gpu.global.add.u32 [%0], 1;" ::"l"(&words->arrived) : "memory");
      uint32_t seen;
      do asm volatile("ld.acquire.gpu.u32 %0, [%1];" : "=r"(seen) : "l"(&words->arrived) : "memory");
      while (seen < number * gridDim.x);
      on = seen < MeetingWords::kClosed;
    } else {
      asm volatile("red.relaxed.gpu.global.or.b32 [%0], %1;" ::"l"(&words->arrived),
                   "r"(MeetingWords::kClosed)
                   : "memory");
      on = false;
    }
  }
  __syncthreads();
  return on;
}

// The threads that share an index: neighbours in a warp.
template <int kThreads>
struct PairLanes {
  static constexpr int kCount = kThreads;
  int lane;
  // All lanes of the warp call it, and the others.
  __device__ uint32_t most_of_warp(uint32_t value) const { return __reduce_max_sync(0xffffffffu, value); }
  // The value that one of them has.
  template <class T>
  __device__ T from(const T& value, int one) const {
    static_assert(sizeof(T) % 4 == 0);
    T taken;
    const auto* in = reinterpret_cast<const uint32_t*>(&value);
    auto* out = reinterpret_cast<uint32_t*>(&taken);
#pragma unroll
    for (size_t k = 0; k < sizeof(T) / 4; ++k) out[k] = __shfl_sync(0xffffffffu, in[k], one, kCount);
    return taken;
  }
  __device__ int64_t sum(int64_t value) const {
#pragma unroll
    for (int k = kCount / 2; k > 0; k /= 2)
      value += __shfl_xor_sync(0xffffffffu, static_cast<long long>(value), k, kCount);
    return value;
  }
  // Of the lanes before this one; of all.
  __device__ uint32_t before(uint32_t value) const {
    uint32_t sum = value;
#pragma unroll
    for (int k = 1; k < kCount; k *= 2) {
      const uint32_t other = __shfl_up_sync(0xffffffffu, sum, k, kCount);
      if (lane >= k) sum += other;
    }
    return sum - value;
  }
  __device__ uint32_t total(uint32_t value) const {
#pragma unroll
    for (int k = kCount / 2; k > 0; k /= 2) value += __shfl_xor_sync(0xffffffffu, value, k, kCount);
    return value;
  }
  __device__ bool all(bool value) const {
    static_assert(kCount < 32);
    const unsigned mine = ((1u << kCount) - 1) << (threadIdx.x % 32 / kCount * kCount);
    return (__ballot_sync(0xffffffffu, value) & mine) == mine;
  }
};

// Threads of a multiprocessor that are to be there at once: with eight lanes there are few, and have 128
// registers.
template <class Lanes>
inline constexpr int kPresent = Lanes::kCount == 8 ? 512 : 1024;
// Each index has its threads for all steps. Whether there is a step is known as soon as it begins: one that
// some block's look stops is not ended, and nobody reads what it left.
template <class Lanes, class F>
__global__ void __launch_bounds__(kLargestBlock, kPresent<Lanes> / kLargestBlock)
    together_kernel(uint32_t end, const uint32_t* cache, uint32_t words, uint32_t steps,
                    MeetingWords* meeting, uint64_t* sums, const __grid_constant__ F f) {
  extern __shared__ uint4 memory[];
  auto* here = reinterpret_cast<uint32_t*>(memory);
  for (uint32_t k = threadIdx.x; k < words; k += blockDim.x) here[k] = cache[k];
  __syncthreads();
  const uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x, i = thread / Lanes::kCount;
  const Lanes lanes{static_cast<int>(thread % Lanes::kCount)};
  const auto kept = f.keep(i, i < end, lanes);
  for (uint32_t number = 1;; ++number) {
    const bool goes_on = f.goes_on(number);
    unsigned long long sum = f(i, i < end, goes_on, kept, here, number, lanes);
    if (__any_sync(0xffffffffu, sum != 0)) {
      for (int k = 16; k > 0; k /= 2) sum += __shfl_down_sync(0xffffffffu, sum, k);
      if (threadIdx.x % 32 == 0) atomicAdd(reinterpret_cast<unsigned long long*>(sums + number), sum);
    }
    if (number == steps || !meet(meeting, number, goes_on)) return;
  }
}

// The threads of a block that work on one thing: each takes its share of the indices 0 .. count - 1, and goes
// on when all are done.
struct Block {
  template <class F>
  __device__ void each(uint32_t count, const F& f) const {
    for (uint32_t k = threadIdx.x; k < count; k += blockDim.x) f(k);
    __syncthreads();
  }
};
template <class F>
__global__ void block_kernel(const __grid_constant__ F f) {
  extern __shared__ uint4 memory[];
  f(blockIdx.x, Block{}, memory);
}

inline unsigned blocks_for(uint32_t count, int block) { return (count + block - 1) / block; }

// Blocks stay for the whole loop where there is much to do, so that what each prepares is prepared seldom.
inline unsigned resident_blocks(const Stream& stream, uint32_t count, int block) {
  return std::min(blocks_for(count, block), static_cast<unsigned>(stream.multiprocessors() * (4096 / block)));
}

template <class F>
void for_each(Stream& stream, uint32_t begin, uint32_t end, int block, const F& f) {
  if (begin >= end) return;
  stream.activate();
  each_kernel<<<blocks_for(end - begin, block), block, 0, stream.get()>>>(begin, end, f);
  check(cudaGetLastError(), "start a kernel");
}
// Lets a kernel's blocks have so many bytes of shared memory; they may have less than 48 KiB unasked.
template <class Kernel>
void ask_for_memory(const Kernel& kernel, size_t bytes, const char* what) {
  if (bytes > size_t{48} * 1024)
    check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(bytes)),
          what);
}
template <class F>
void for_each_cached(Stream& stream, uint32_t begin, uint32_t end, int block, const void* cache, size_t words,
                     const F& f) {
  if (begin >= end) return;
  stream.activate();
  ask_for_memory(cached_kernel<F>, words * 4, "hold a rule's tables in a block's shared memory");
  cached_kernel<<<resident_blocks(stream, end - begin, block), block, words * 4, stream.get()>>>(
      begin, end, static_cast<const uint32_t*>(cache), static_cast<uint32_t>(words), f);
  check(cudaGetLastError(), "start a kernel");
}
// Steps 1 to `steps` of all indices below `end`, in one launch, while f.goes_on(step). What f gives is added
// up in sums[step]. Waits for their end. False, and nothing is done: the device does not hold so many at
// once, or, where it has a choice, they are more than the run's share of it.
template <class Lanes, class F>
bool go_on_together(Stream& stream, uint32_t end, int block, const void* cache, size_t words, uint32_t steps,
                    Meeting& meeting, uint64_t* sums, bool has_choice, const F& f) {
  stream.activate();
  const auto kernel = together_kernel<Lanes, F>;
  ask_for_memory(kernel, words * 4, "hold a rule's tables in a block's shared memory");
  int each = 0;
  check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&each, kernel, block, words * 4), "count blocks");
  const unsigned blocks = blocks_for(end * Lanes::kCount, block);
  const auto most = static_cast<unsigned>(each * stream.multiprocessors());
  if (blocks > most || (has_choice && blocks > Sharing::all().share_of(most))) return false;
  const Sharing::Stay stay(stream.device(), {blocks, each}, stream.multiprocessors());
  MeetingWords* met = meeting.begin(stream);
  const auto* from = static_cast<const uint32_t*>(cache);
  auto count = static_cast<uint32_t>(words);
  void* arguments[] = {&end, &from, &count, &steps, &met, &sums, const_cast<F*>(&f)};
  const cudaError_t error =
      cudaLaunchCooperativeKernel(reinterpret_cast<const void*>(kernel), dim3(blocks),
                                  dim3(static_cast<unsigned>(block)), arguments, words * 4, stream.get());
  // A device that others share may hold fewer blocks than it says.
  if (error == cudaErrorCooperativeLaunchTooLarge || error == cudaErrorNotSupported) {
    (void)cudaGetLastError();
    return false;
  }
  check(error, "start a kernel");
  stream.synchronize();
  return true;
}
// Calls f(index, block, memory), a block of threads and `bytes` of its memory each.
template <class F>
void for_each_block(Stream& stream, uint32_t count, int threads, size_t bytes, const F& f) {
  if (count == 0) return;
  stream.activate();
  ask_for_memory(block_kernel<F>, bytes, "hold a problem in a block's shared memory");
  block_kernel<<<count, threads, bytes, stream.get()>>>(f);
  check(cudaGetLastError(), "start a kernel");
}
template <class F>
void sum_each(Stream& stream, uint32_t begin, uint32_t end, int block, const F& f, uint64_t* out) {
  if (begin >= end) return;
  stream.activate();
  sum_kernel<<<resident_blocks(stream, end - begin, block), block, 0, stream.get()>>>(begin, end, f, out);
  check(cudaGetLastError(), "start a kernel");
}
template <class F>
void max_each(Stream& stream, uint32_t begin, uint32_t end, int block, const F& f, uint32_t* out) {
  if (begin >= end) return;
  stream.activate();
  max_kernel<<<resident_blocks(stream, end - begin, block), block, 0, stream.get()>>>(begin, end, f, out);
  check(cudaGetLastError(), "start a kernel");
}
template <class Lanes, class F>
__global__ void __launch_bounds__(kLargestBlock)
    max_shared_kernel(uint32_t end, const __grid_constant__ F f, uint32_t* out) {
  const uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x, i = thread / Lanes::kCount;
  const uint32_t most =
      __reduce_max_sync(0xffffffffu, f(i, i < end, Lanes{static_cast<int>(thread % Lanes::kCount)}));
  if (threadIdx.x % 32 == 0) atomicMax(out, most);
}
// The most that f(index, whether there is one, lanes) answers, of all indices below `end`, each of some
// lanes.
template <class Lanes, class F>
void max_shared(Stream& stream, uint32_t end, int block, const F& f, uint32_t* out) {
  if (end == 0) return;
  stream.activate();
  max_shared_kernel<Lanes><<<blocks_for(end * Lanes::kCount, block), block, 0, stream.get()>>>(end, f, out);
  check(cudaGetLastError(), "start a kernel");
}
inline void exclusive_sums(Stream& stream, const uint32_t* in, uint32_t* out, uint32_t count) {
  stream.activate();
  size_t bytes = 0;
  const int n = static_cast<int>(count);
  check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, in, out, n, stream.get()), "sums");
  void* scratch = nullptr;
  check(cudaMallocAsync(&scratch, bytes, stream.get()), "allocate device memory");
  check(cub::DeviceScan::ExclusiveSum(scratch, bytes, in, out, n, stream.get()), "sums");
  check(cudaFreeAsync(scratch, stream.get()), "free device memory");
}

}  // namespace cuboct::gpu
