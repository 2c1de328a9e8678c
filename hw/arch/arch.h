// SPDX-License-Identifier: MIT
// A machine description: what an arch file (TOML) says, with the defaults that serve without one.
#pragma once

#include <cstdint>
#include <string>

#include "hw/arch/carry.h"
#include "hw/arch/devices.h"
#include "hw/arch/link_code.h"
#include "model/base/places.h"
#include "model/base/vec.h"
#include "model/contract/fixed_rule.h"
#include "model/contract/quantise.h"

namespace cuboct {

// Of the force pipe's products.
enum class Multipliers : uint8_t {
  parallel,  // each has its own: a pair per cycle
  shared,    // one serves the axes in turn: a pair every `axes` cycles
  serial     // each has its own, a bit per cycle, of logic alone: a pair every 15 to 28 cycles
};

// Of a format or a capacity: chosen by what the scene asks for (hw/arch/auto_widths.h).
inline constexpr int kAutomatic = 0;
Widths automatic_widths();  // every one of them

// When a node uses the halo records that come over its links.
enum class Halos : uint8_t {
  phases,  // those of an axis once all have come
  arrival  // each as it comes; it goes on to the later axes at once, and those that can meet no own particle
           // are not presented
};

struct Arch {
  std::string name = "default";
  std::string text;           // of the file; empty: the defaults
  double cell_edge = 0;       // m; 0: the pair law's cutoff, or the next length that divides a periodic box
  int capacity = kAutomatic;  // particles that a cell holds
  int filter_lanes = 8;       // own particles that a candidate meets per cycle
  int force_pipes = 1;        // pairs per cycle
  Halos halos = Halos::phases;
  int streamers = 1;  // candidates per cycle: 1, or 2 where halos are used on arrival
  Multipliers multipliers = Multipliers::parallel;
  int queue_depth = 16;  // (candidate, mask) entries between filter and pipes
  bool overlap = true;   // candidates are filtered while the exchange still runs
  Cell brick{1, 1, 1};   // cells that a node serves, along x, y, z
  bool narrow_memories =
      false;          // words of a beat's width, one port to read: hw/plan/plan.h says what that asks
  int link_bits = 0;  // payload bits per beat; 0: one halo record per beat
  LinkCheck link_check = LinkCheck::none;
  DeviceCut boards;  // on how many devices the nodes stand
  Widths widths = automatic_widths();
  TableChoice table;
  Carry carry;
  Places places;  // of the file's keys
};

// Throws InputError with file:line:column. An empty path gives the defaults.
Arch read_arch(const std::string& path);
// The same for text in memory; `path` stands in messages.
Arch parse_arch(const std::string& text, const std::string& path);

}  // namespace cuboct
