// SPDX-License-Identifier: MIT
// What a run will take of the machine, told before it starts.
#pragma once

#include <cstdint>
#include <string>

#include "cli/command.h"
#include "cli/items.h"

namespace cuboct {

struct RunSize {
  std::string engine = "lattice";
  uint64_t steps = 0;
  uint64_t frame_every = 0, energy_every = 0;  // 0: first and last
  uint64_t probe_every = 0;                    // 0: never
  uint64_t hash_every = 100;
  bool cycles = false;    // spans of all phases of all nodes are kept
  bool states = true;     // frames hold particles, not pictures alone
  uint32_t raster = 800;  // pixels along the body
  int threads = 0;        // 0: as many as suit the scene
  int ranks = 1;
  bool checkpoints = false;
};

// The scene's run, of `steps` instead of its own.
RunSize run_size(const Scene& scene, uint64_t steps);

struct Estimate {
  uint64_t load_steps = 0;  // of a static run: what follows is of one evaluation of forces; else 0
  double particle_steps = 0;
  double seconds = 0;                // 0: no rate is known for this engine
  double probing = 0, energies = 0;  // of them for the readings of probes, and of energies
  double energy_readings = 0;        // how many
  double rate = 0;                   // particle-steps/s of one thread that `seconds` counts with
  int threads = 1;
  double memory = 0;  // bytes; of it what grows with the steps:
  double hashes = 0, spans = 0, samples = 0;
  double disk = 0;   // bytes that --out takes
  double frame = 0;  // of it, each of the frames
  double frames = 0;
  double checkpoints = 0;  // and what a run keeps that is to go on
};

// Particles, cells and steps are counted. Time and bytes per particle are those measured on example scenes:
// time is right within a factor of 3 or so on a machine of today where nothing rests, memory and disk
// within 2.
Estimate estimate(const Scene& scene, const Plan& plan, const RunSize& size);

void add_estimate(Items& items, const Estimate& estimate);

// Throws InputError where frames or samples are too many to list. `frames_given`: by the command line.
void check_lists(const Scene& scene, const RunSize& size, bool frames_given);

// Throws InputError where the run needs more memory than is free, or, into the directory `out` (empty: none),
// more disk, or more than kMostSeconds: at the key or option that asks for most of it, with what would do.
void check_fits(const Scene& scene, const RunSize& size, const Estimate& estimate, const std::string& out);

// Throws InputError, at the key that asks for most, where the particles and cells of the machine take more
// memory than is free: of commands that run it on the lattice engine for a few steps.
void check_held(const Scene& scene, const Plan& plan, bool anyway);

// Throws InputError where threads (0: not given) or ranks are more than the machine or the scene can use.
// `anyway`: of the machine, that is meant; the scene's nodes bound ranks all the same.
void check_workers(int threads, int ranks, bool anyway, const Plan& plan);

// Throws InputError where so many steps of an engine, asked for by `option`, take more than kMostSeconds.
void check_counted(const std::string& option, const std::string& engine, const Scene& scene, const Plan& plan,
                   uint64_t steps, bool anyway);

}  // namespace cuboct
