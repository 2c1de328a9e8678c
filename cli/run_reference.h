// SPDX-License-Identifier: MIT
// The rule in real numbers over the same scene: the same curves and frames, no bits to compare.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/items.h"
#include "cli/recorder.h"
#include "model/real/reference.h"
#include "model/trace/trace.h"

namespace cuboct {

// What the command line says about real numbers.
struct RealChoice {
  std::string precision;  // "fixed", "float", "double"; empty: the engine's own choice
  std::string integrator = "euler";

  void add_to(CLI::App& command);  // --precision and --integrator
  // Throws InputError where an option is given that this engine does not have, or not so.
  void check_used(const std::string& engine) const;
  // Whether the engine then computes in real numbers.
  bool is_real(const std::string& engine) const;
  RealOptions options() const;  // of the reference
};

struct ReferenceRun {
  Trace trace;  // curves, no hashes
  Items summary;
  bool failed = false;  // the watch found something
};

// Ctrl-C gives the run so far. Frames go to the recorder where there is one. `threads` of `options` may be 0:
// as many as suit the scene.
ReferenceRun run_reference(const Loaded& loaded, RealOptions options, uint64_t steps,
                           const std::vector<uint64_t>& frame_steps, const std::vector<uint64_t>& probe_steps,
                           bool watch, Recorder* recorder);

}  // namespace cuboct
