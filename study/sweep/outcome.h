// SPDX-License-Identifier: MIT
// What is measured at one point of a study. Plain numbers, so that engines on other machines can add theirs.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "study/sweep/settings.h"

namespace cuboct::study {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// Against the truth (truth.h). Not measured: nan, and `why` says so.
struct Errors {
  // Of the pair forces on all particles at the truth's kept states, in OpenMM's measure 2|a-b|/(|a|+|b|).
  // P. Eastman et al., OpenMM User Guide, section "Accuracy".
  double force_median = kNotMeasured, force_999 = kNotMeasured, force_max = kNotMeasured;
  // Root mean square distance of the particles from the truth's at the horizon, over the pitch (without
  // packing: the cutoff).
  double trajectory = kNotMeasured;
  // Of the total energy, over the largest kinetic energy of the run: slope per step and per oscillation
  // (2 pi over the largest frequency); scenes that keep their energy only.
  double drift_per_step = kNotMeasured, drift_per_oscillation = kNotMeasured;
  // |P(end) - P(0)| over sum |m v| at the end; scenes that keep their momentum only.
  double momentum = kNotMeasured;
  // Of each of the study's figures: |value - truth| / |truth|.
  std::vector<double> figures;
  std::vector<double> values;  // the figures themselves
};

struct Speed {
  double particle_steps = kNotMeasured;     // per second of host time, median of the repeats
  double simulated_seconds = kNotMeasured;  // per second of host time
  double spread = kNotMeasured;             // (largest - smallest)/median of the repeats
  int repeats = 0;
  std::string machine = {};  // where it was measured; empty: on the study's own
};

enum class Status : uint8_t {
  done,
  unstable,  // left the truth by more than a pitch at the horizon, or stopped: a fault, not finite
  refused,   // the settings make no plan: InputError's text in `why`
};

struct Outcome {
  Settings settings;
  Status status = Status::done;
  std::string why;   // one line; empty where there is nothing to say
  double dt = 0;     // s
  double pitch = 0;  // m
  uint32_t particles = 0;
  uint64_t steps = 0;
  double cost = kNotMeasured;         // cost.h: transistors times time per simulated second
  int halo_bits = 0, table_bits = 0;  // of the plan, fixed only: a record, and all tables
  Errors errors;
  Speed speed;
  std::string machine;  // where its errors were measured; empty: on the study's own (store.h)

  // Where its speed was measured, which is what tells machines apart; without a speed, its errors.
  const std::string& measured_on() const {
    const bool none = std::isnan(speed.particle_steps) && std::isnan(speed.simulated_seconds);
    return none ? machine : speed.machine;
  }
};

// An error's text as it stands in `why`: its hint after a semicolon.
std::string one_line(std::string text);

}  // namespace cuboct::study
