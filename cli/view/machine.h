// SPDX-License-Identifier: MIT
// The machine of a run that is over, as its page shows it: the lattice of nodes, the particles that each held
// at a frame, and the phases of each step as the run recorded them. docs/reference/view.md has the blocks.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/run/outputs.h"
#include "model/trace/trace.h"

namespace cuboct {

class ViewMachine {
 public:
  // Keeps the references. `real`: a run in real numbers. InputError where the trace's phases are not of the
  // plan's nodes.
  ViewMachine(const Loaded& loaded, const Trace& trace, const RunRecord& record, bool real);

  bool is_there() const { return missing_.empty(); }
  size_t steps() const { return steps_; }  // whose phases were recorded; 0: none
  size_t step_bytes() const;               // of spans()

  // Blocks, little-endian: of each node 11 words of 32 bits; of each its particles, 32 bits; of a step its
  // first cycle in 64 bits, then start and end of each phase of each node after that, 32 bits each.
  std::string nodes() const;
  std::string held(const State& state) const;
  std::string spans(size_t step) const;

  // What makes a picture of the blocks. `kept`: the steps whose spans the page has; nothing: all.
  std::string json(const std::optional<std::vector<size_t>>& kept) const;

 private:
  std::string per_step() const;

  const Loaded& loaded_;
  const Trace& trace_;
  std::string missing_, command_;  // why there is no machine; how its cycles are recorded
  size_t steps_ = 0;
};

}  // namespace cuboct
