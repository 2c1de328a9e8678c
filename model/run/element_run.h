// SPDX-License-Identifier: MIT
// Runs a study of macro-elements set by set. It leaves its progress in a file, and goes on where that ends.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "model/atoms/multiscale/element_study.h"
#include "model/atoms/multiscale/stretch.h"

namespace cuboct {

// Velocities on the low face of the axis that is neither the wave's nor `across`.
struct WaveSnapshot {
  double time = 0;                            // s
  std::vector<std::array<double, 3>> points;  // m along the wave, m across it, m/s along the polarisation
};

struct WaveOutcome {
  std::vector<FrontPoint> front;
  FrontSpeed speed;
  double dt = 0;  // s
  uint64_t steps = 0;
  double largest_strain = 0;  // of a slice's velocity over the front's speed
  std::vector<WaveSnapshot> snapshots;
};

struct SetOutcome {
  std::vector<StretchPoint> stretch;
  Moduli moduli;
  WaveOutcome wave;
  SampleWork work;
  double seconds = 0;    // of the wall's clock
  double processor = 0;  // s, of all threads of this process
};

// `set` from 0, part from 0 to 1: how far a study is, in words.
std::string set_status(size_t set, size_t sets, double part);

// Where the set at hand is.
struct ElementProgress {
  SetOutcome outcome;
  bool waving = false;  // else stretched as far as `outcome` says
  uint64_t steps = 0;   // of the wave
  std::vector<std::vector<double>> history;
  std::vector<Vec3> x, v;
  Vec3 period = Vec3::Zero();
  std::vector<ElementSample> samples;
  bool begun = false;  // x ... samples hold something
};

struct ElementRunOptions {
  int threads = 1;
  RelaxerMaker relaxer{};  // of ElementOptions
  double save_every = 20;  // s, of the wall's clock
  std::string progress;    // file; empty: none is left
  // How much of the set is done, from 0 to 1; with the set from 0. False: stop now.
  std::function<bool(size_t set, double part)> see = [](size_t, double) { return true; };
};

// Thrown where `see` says so, after the progress was saved.
class ElementRunStopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped"; }
};

// The outcomes of all sets. InputError where the file of progress is another study's, or damaged;
// ElementError and std::runtime_error of a body that fails, with the set before it where there are several.
std::vector<SetOutcome> run_elements(const ElementStudy& study,
                                     const std::shared_ptr<const SampleMaterial>& material,
                                     const ElementRunOptions& options);

}  // namespace cuboct
