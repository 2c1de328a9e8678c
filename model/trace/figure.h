// SPDX-License-Identifier: MIT
// One number out of a run's curves: what a scene is run for.
#pragma once

#include <string>
#include <vector>

#include "model/config/config.h"
#include "model/trace/trace.h"

namespace cuboct {

struct Figure {
  enum class Kind : uint8_t {
    modulus,     // slope of `curve` over `against` (stress over strain) between `from` and `to` of `against`,
                 // by least squares
    strength,    // largest value of `curve`, by a parabola through the three samples around it
    frequency,   // Hz: of the strongest oscillation of `curve` about its mean in [from, to] s, by a windowed
                 // discrete Fourier transform with its peak interpolated
    break_time,  // s: from when on `curve` stays below `fraction` of its largest value, interpolated between
                 // samples
    mean,        // of `curve` over [from, to] s
    final        // the last value of `curve`
  };
  Kind kind = Kind::final;
  std::string name;         // for reports; default: the kind
  std::string curve;        // "<probe>.<quantity>", or "energy.total" and its parts
  std::string against;      // modulus
  double from = 0, to = 0;  // to 0: the end
  double fraction = 0.5;    // break_time

  std::string unit(const std::vector<Curve>& curves) const;
};

// A [[figure]] table. Throws InputError with file:line:column.
Figure read_figure(const ConfigTable& table);

// `dt` in s. Throws InputError where a curve is not there (with the nearest name); std::runtime_error, saying
// why, where the curves do not hold the figure (too few samples in the window, no peak, never broken).
double value_of(const Figure& figure, const std::vector<Curve>& curves, double dt);

}  // namespace cuboct
