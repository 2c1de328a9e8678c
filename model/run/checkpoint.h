// SPDX-License-Identifier: MIT
// A run's state on disk. A checkpoint is written under another name, brought to the disk and renamed:
// whatever kills the run, the file of this name is a whole one. Layout: docs/reference/checkpoint.md.
#pragma once

#include <string>
#include <vector>

#include "model/analysis/measure.h"
#include "model/run/engine.h"
#include "model/run/word_file.h"

namespace cuboct {

// Everything but the particles, which follow by cell and slot.
struct CheckpointHead {
  uint64_t plan_hash = 0;
  uint64_t step = 0;
  uint32_t particles = 0;
  // How the trace is kept: a run that resumes must keep it alike.
  uint64_t hash_every = 1;
  bool cycles = false, energies = false;
  // The run so far.
  double seconds = 0;
  double largest_speed = 0;
  Int3 momentum{};  // at step 0; in real numbers the doubles' bits
  EngineMemory engine;
  ProbeMeter::Memory probes;
  WordMark journal;
};

// `displaced`: the rule holds particles by force, their displacements count.
void write_checkpoint(const std::string& path, const CheckpointHead& head, Engine& engine, bool displaced);

class CheckpointReader {
 public:
  // Reads the whole file once for its hash. Throws InputError where it is no checkpoint, damaged, or made by
  // another plan.
  CheckpointReader(const std::string& path, uint64_t plan_hash, bool displaced);

  const std::string& path() const { return path_; }
  const CheckpointHead& head() const { return head_; }
  Particle next();  // head().particles times
  // Of an engine in real numbers: all at once, by id; types stay. `kept`: of BondState.
  void next(Body& body, std::vector<uint64_t>& kept);
  void rewind();  // to the first particle

 private:
  std::string path_;
  WordReader in_;
  bool displaced_;
  CheckpointHead head_;
  uint64_t first_ = 0;  // where the particles begin
};

}  // namespace cuboct
