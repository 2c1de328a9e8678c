// SPDX-License-Identifier: MIT
// The hints of quantise()'s refusals: what integers would hold in place of what they cannot. Each names a
// value that is enough; tests give it and see the refusal gone.
#pragma once

#include <string>

#include "model/contract/fixed_rule.h"
#include "model/contract/rule.h"

namespace cuboct {

// A value may be off by this share of itself: coarser, and the run would be of another scene.
inline constexpr double kMostOff = 0.01;

// Of a value that is to be below `limit` and grows as dt^power.
std::string dt_that_holds(double dt, double value, double limit, int power);

// Of a vector of this length, in units of the lattice, that fractional bits round too coarsely.
std::string guard_that_keeps(double whole, const Widths& widths);

// The most fractional bits with which kGainBits hold the gains of all controllers.
int gain_frac_of(const Rule& rule);

// Of a controller's gains that are too small beside the largest of all: those of `type` that would be off by
// `most_off` of themselves at most.
std::string gains_that_are_kept(const Rule& rule, size_t type, double most_off = kMostOff);

// Of kicks that have `missing` fractional bits less than velocities. `widths`: as they were tried.
std::string kicks_that_fit(const Widths& widths, int missing, double dt);

// Of damping that is `missing` bits too strong beside the pair law.
std::string damping_that_fits(const Widths& widths, int missing);

// What any value is computed with.
inline constexpr const char* kDoublesHold = "doubles hold any (--engine reference)";

inline constexpr int kGainBits = 18, kMostGainFrac = 24, kWidestStrength = 27, kMostVelocityFrac = 50,
                     kMostGuard = 30, kWidestRelative = 27;

}  // namespace cuboct
