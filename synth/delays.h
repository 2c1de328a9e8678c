// SPDX-License-Identifier: MIT
// What is known of a device's delays before anything is placed: of its cells as their maker's tools tell
// them, of its wires on average. All in ns, at the slow corner.
#pragma once

#include <string>
#include <vector>

#include "synth/target.h"

namespace cuboct::synth {

// Pins are patterns: '#' is any number of digits, '*' any text, '|' stands between alternatives.
struct CellDelays {
  struct Arc {
    const char *from, *to;
    double ns;
  };
  struct Setup {
    const char *pin, *clock;
    double ns;
  };
  const char* cell;             // a pattern of types
  std::vector<Arc> arcs;        // from input to output
  std::vector<Arc> clock_to_q;  // from clock to output
  std::vector<Setup> setups;
  const char* parameter = nullptr;  // null, or one that tells such a cell from others of its type,
  const char* value = nullptr;      // by this
};

// A connection that is no common wire.
struct Link {
  const char *from_cell, *from_pin, *to_cell, *to_pin;
  double ns;          // of the connection, or beside the wire
  bool wire = false;  // a common wire is part of it
  // Which of a net's sinks it can be: each; one of those that match; that one which is alone on its net.
  enum class Which { each, one, alone } which = Which::each;
};

// A wire: share * (near + slope * log2(sinks of its net, at most `most_sinks`) + far). The slope is `spread`
// where it ends at a pin whose likes lie apart (bits of memories and register banks), `doubling` elsewhere.
// `far` counts at each end that lies in a column or row of its own (DSP, block RAM).
struct Wires {
  double near, doubling, spread, far;  // ns
  double share;                        // of what was measured on critical paths, which are no average ones
  double most_sinks;                   // the one that matters lies no farther on a wider net
  const char *far_from, *far_to;       // patterns of types
  const char *spread_cells, *spread_pins;
  std::vector<Link> links;  // the first that matches counts
};

struct Delays {
  std::string device;             // and its speed grade
  std::vector<CellDelays> cells;  // the first that matches counts
  const char* untimed;            // a pattern of types that stand between the device's inside and its pins
  Wires wires;
  double error =
      0;  // of a clock estimated with them: the largest share that was met, see docs/reference/synth.md
};

// Null where nothing is known.
const Delays* delays_of(const Target& target);

// Whether `text` is what a pattern describes.
bool matches(const char* pattern, const std::string& text);

// ns of the connection from one pin to another on a net of `sinks` sinks of which `alike` match the same
// link. `taken`: another sink has the connection that only one can have; it is set where this one takes it.
double wire_delay(const Wires& wires, const std::string& from_cell, const std::string& from_pin,
                  const std::string& to_cell, const std::string& to_pin, size_t sinks, bool& taken);

}  // namespace cuboct::synth
