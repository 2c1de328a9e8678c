// SPDX-License-Identifier: MIT
// The directory of a run, written as the run goes: no more than the frame at hand is held.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/items.h"
#include "cli/run/outputs.h"
#include "model/trace/trace.h"

namespace cuboct {

struct RecorderOptions {
  std::string directory;
  RunRecord record;
  bool resume = false;                            // goes on with the run that the directory holds
  bool force = false;                             // a run that did not end may be replaced
  bool no_states = false;                         // of the frames, rasters alone
  bool csv = false;                               // curves.csv too
  std::vector<std::string> frames{"xyz", "vtp"};  // for viewers: "xyz", "xyz.gz", "ase", "vtp", "lammps"
  uint32_t raster = 800;                          // pixels along the body
  bool real = false;                              // a run in real numbers
  bool si = false;                                // the trace holds positions in metres too
  bool cycles = false;                            // it holds cycles
  // At most what the trace will hold besides frames, bytes: taken from the disk before the first step, so
  // that frames that fill it cost themselves alone.
  uint64_t rest = 0;
  // Each frame, with axial strain; the state that it was made of, or null in real numbers.
  std::function<void(const Frame&, const State*)> see{};
};

class Recorder {
 public:
  // Throws InputError where the directory cannot be made or written to, another process has it, or it holds a
  // run that did not end and is not to go on. What an earlier run left stays until the first frame, or
  // finish().
  Recorder(RecorderOptions options, const Loaded& loaded);
  ~Recorder();  // what was written stays
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // The frames, ascending in step. The first throws InputError where the disk has no room for the rest of the
  // trace; later ones that do not fit are left out.
  void keep(const State& state);
  void keep(const RealFrame& frame);

  // The rest. `state` of RunRecord, but for what is incomplete. `trace` has no frames.
  void finish(const Trace& trace, const Items& summary, const std::string& state);
  // What did not fit, as one line for the user; empty: nothing.
  std::string trouble() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cuboct
