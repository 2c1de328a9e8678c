// SPDX-License-Identifier: MIT
// A scene on one or more GPUs of one host: in the fixed rule, with golden's bits after every step, or in real
// numbers. Both share their storage: particles by cell, pair lists with a skin, batches of steps that the
// devices do without the host. docs/reference/gpu.md.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "hw/plan/plan.h"
#include "model/analysis/measure.h"
#include "model/contract/state.h"
#include "model/scene/scene.h"

namespace cuboct::gpu {

enum class Arithmetic : uint8_t { fixed, float32, float64 };
const char* to_string(Arithmetic arithmetic);  // "fixed", "float", "double"

inline constexpr int kMostSlabs = 16;
// Particles that one device takes through a batch of steps in one launch. More are done sooner by a launch
// for each step (docs/measured/gpu.md).
inline constexpr uint32_t kMostTogether = 34'000;
// Fewer have more threads each: a device is to be filled, and not to take its particles in turns.
inline constexpr uint32_t kMostOfEightLanes = 8'000, kMostOfFourLanes = 20'000;

struct Options {
  // CUDA's ordinals, one per slab of the scene, at most kMostSlabs. One that comes twice holds two slabs:
  // bits are the same.
  std::vector<int> devices{0};
  int block = 128;                    // threads of a block, a multiple of 32; leaves no mark in the bits
  uint32_t together = kMostTogether;  // 0: a launch for each step; leaves no mark in the bits
};

struct Counters {
  uint64_t list_builds = 0;     // of the pair lists
  uint64_t near_stops = 0;      // batches that ended as a near list (emu/gpu/step.h) served no longer
  uint64_t golden_steps = 0;    // of the fixed rule, done by golden on the host, as a fault seemed near
  uint64_t longest_list = 0;    // partners of one particle
  double listed_pairs = 0;      // entries per particle in the last list
  uint64_t halo_particles = 0;  // copies of neighbours' particles, all devices, at the last list
  uint64_t device_bytes = 0;    // memory asked for, all devices
};

// What probes and energies need of a state, read on the devices.
struct Reading {
  uint64_t step = 0;
  // Of the probed particles in the order of their ids: m; N, of the pairs; m/s, at the time of the positions.
  std::vector<Vec3> x, force, v;
  Energies energies;  // zero unless asked for
  // J, with the energies: the sum over pairs of F . d, of the force on j by i and d = x_j - x_i; positive
  // where they repel. Minus the trace of model/analysis/measure.h's virial_stress, times the volume.
  double virial = 0;
  double largest_speed = 0;  // m/s, along an axis
};

// A step of a real engine in which a position leaves all bounds: the state before it stands.
class LostPosition : public std::runtime_error {
 public:
  LostPosition(const std::string& text, uint64_t step, uint32_t particle)
      : std::runtime_error(text), step(step), particle(particle) {}
  uint64_t step;  // done before it
  uint32_t particle;
};

// A memory that cannot be one of the scene's.
class DamagedMemory : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Engine {
 public:
  virtual ~Engine() = default;

  // Advances `steps` steps; where `hashes` is given, the state's hash after each is appended (fixed only).
  // Throws at the first step that cannot be done (fixed: golden's RunError; real: LostPosition): the state
  // before it stands. Returns early, after a complete step, where model/base/interrupt.h
  // says so.
  virtual void advance(uint64_t steps, std::vector<uint64_t>* hashes = nullptr) = 0;
  virtual uint64_t step_count() const = 0;

  // Of the particles given to `probe`, and the energies where `energies`.
  virtual Reading read(bool energies) = 0;
  // Ids, ascending, whose x, force and v `read` gives from now on.
  virtual void probe(const std::vector<uint32_t>& ids) = 0;

  // Fixed: sorted by id. RunError of real engines, which have none.
  virtual State state() = 0;
  virtual uint64_t hash() = 0;
  // SI; positions are not wrapped into a periodic box in the real engines. No types.
  virtual Body body() = 0;

  // Of real engines: what another one of the same scene, on however many devices, goes on from with the same
  // bits.
  virtual std::vector<uint64_t> memory() { return {}; }

  virtual const Counters& counters() const = 0;
};

// Velocities of `body`, as of the scene, live half a step before its positions (semi-implicit Euler).
// Throws InputError, before anything is allocated, where the scene does not fit the devices (with numbers),
// or an ordinal is not there; std::runtime_error where CUDA fails. Keeps references to scene and plan.
std::unique_ptr<Engine> make_fixed_engine(const Scene& scene, const Plan& plan, const State& initial,
                                          const Options& options);
std::unique_ptr<Engine> make_real_engine(const Scene& scene, const Body& body, Arithmetic arithmetic,
                                         const Options& options);

// The memory of an engine after so many steps.
struct Memory {
  uint64_t step = 0;
  std::span<const uint64_t> words;
};
// Goes on from there. Throws DamagedMemory too.
std::unique_ptr<Engine> resume_real_engine(const Scene& scene, const Body& body, Arithmetic arithmetic,
                                           const Options& options, const Memory& memory);

// A device as it is found.
struct Device {
  int ordinal = 0;
  std::string name;  // "NVIDIA H100 80GB HBM3"
  std::string bus;   // PCI bus id, as NVML wants it
  int multiprocessors = 0;
  uint64_t memory = 0, free = 0;  // bytes
  uint64_t block_memory = 0;      // bytes that threads of a block may share
};
// Empty where there is no driver, or no device; `why` then says which.
std::vector<Device> find_devices(std::string* why = nullptr);

// Before the first device is used: engines of several threads will go on at once. Each keeps to one thread,
// and all share the devices and their memory. `sleeping`: a thread that waits leaves its core to others.
void share_devices(bool sleeping);

}  // namespace cuboct::gpu
