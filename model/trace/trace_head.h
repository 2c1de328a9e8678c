// SPDX-License-Identifier: MIT
// What a trace says of itself beyond its numbers: what makes metres and seconds of them, and where they come
// from. `cuboct run` writes it into the trace that it keeps; docs/reference/trace.md lists the attributes.
#pragma once

#include <string>

#include "model/contract/fixed_rule.h"
#include "model/contract/lattice.h"
#include "model/scene/scene.h"

namespace cuboct {

namespace hdf5 {
class Writer;
}

struct TraceHead {
  const Scene& scene;
  // Null in a run of real numbers, whose states are in SI.
  const FixedRule* rule = nullptr;
  const Lattice* lattice = nullptr;
  Vec3 origin = Vec3::Zero();  // m, lower corner of cell (0,0,0)
  std::string arch;            // text of its file; empty: the defaults
  bool si = false;             // states in SI as well, as frames/x_si and frames/v_si
  bool cells = true;           // the lattice's cells too, of use where something counts by them
};

// Of where the scene packs its particles, and of the box that repeats. Runs of one packing have the same
// particles.
uint64_t packing_hash(const Scene& scene);

// Of the program: "0.1.0".
const char* program_version();

// Throws InputError where the disk has no room, and leaves the file as it was.
void write_head(const hdf5::Writer& out, const TraceHead& head);

}  // namespace cuboct
