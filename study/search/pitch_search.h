// SPDX-License-Identifier: MIT
// Which pitch of a scene keeps a figure within an error: the scene is run on finer and finer packings, and
// the figure's limit is read off a straight line over the pitch.
//
// Why a straight line: the surface of a packed body has fewer bonds, which is a share of the body of the
// order of pitch over size, while the bulk of the packing is off by its square. The faces of a shape fall
// between planes of sites by a part of a pitch that looks random: scatter, which is proportional to the pitch
// as well.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/trace/figure.h"
#include "study/sweep/settings.h"

namespace cuboct::study {

struct PitchQuestion {
  Base base;
  Figure figure;
  std::string engine = "lattice";  // or "reference"
  double error = 0.05;             // wanted, relative
  uint64_t most_particles = 1'000'000;
  int threads = 1;
};

// Throws InputError at the key of a scene that would be another body at another pitch: a law, a mass or a
// time step given for one pitch, a number of steps, stages, a state to begin from.
void check_refinable(const Base& base);

struct PitchRun {
  double pitch = 0;  // m
  int shift = 0;     // of the packing: by which of the vectors below
  uint64_t particles = 0;
  double value = 0;  // of the figure
  std::string unit;
  uint64_t particle_steps = 0;
  double seconds = 0;  // of host time
};

// value = limit + pitch (slope + scatter of each run). Over the pitch that is a straight line in 1/pitch with
// an even scatter: limit and slope are those of least squares.
struct PitchLine {
  double limit = 0, slope = 0;
  double scatter = 0;       // of value over pitch: what 90 % of runs stay within
  double limit_within = 0;  // the limit is known so well, with a probability of 90 %

  // Relative: how far the figure may be from its limit at that pitch.
  double error_at(double pitch) const;
  // The pitch with that error; none where the limit is not known so well.
  std::optional<double> pitch_for(double error) const;
};
// Of three or more runs.
PitchLine line_through(const std::vector<PitchRun>& runs);

// How often a pitch is run, with the packing shifted within its cell: shifts cost less than finer pitches,
// and tell the scatter as well.
inline constexpr int kShifts = 3;
// Fraction of the cubic cell by which a packing is shifted along its axes: 0 for the first, then the points
// of R3 (M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018).
Vec3 shift_of(int k);

struct PitchAnswer {
  std::vector<PitchRun> runs;  // from coarse to fine, each pitch 1/sqrt(2) of the last, with all its shifts
  std::optional<PitchLine> line;
  // The coarsest that keeps the error, of those between the coarsest and the finest run; none where more
  // particles would be needed than are allowed.
  std::optional<double> pitch;
};

// Results are kept in `directory`: the same question goes on with those that are missing. `see` is called
// after the runs of each pitch. No run has more particles than are allowed: InputError where the scene's own
// pitch makes more. Throws Interrupted, InputError, and std::runtime_error where a run ends early
// or has no such figure.
PitchAnswer find_pitch(const PitchQuestion& question, const std::string& directory,
                       const std::function<void(const PitchAnswer&)>& see);

}  // namespace cuboct::study
