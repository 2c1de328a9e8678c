// SPDX-License-Identifier: MIT
// What a study's machines take: cycles, energy, area, room on a device, errors.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "study/machines/counts.h"
#include "study/machines/machine_study.h"
#include "study/sweep/kept_lines.h"
#include "study/sweep/runner.h"

namespace cuboct::study {

// What all nodes of a machine take of an FPGA; a count of a resource is a band.
struct DeviceUse {
  MachineValue lut, ff, dsp, bram;
  MachineValue share;  // the largest share of the room that a plan should use (synth/target.h): 1 is full
};
// Before any synthesis; nothing is known of some devices and kinds of nodes.
using EstimateDevice = std::function<DeviceUse(const Plan& plan, const std::string& target)>;

struct MachineFinding {
  MachineChoice choice;
  std::string why;  // no machine: the reason, on one line
  uint32_t nodes = 0, particles = 0, cells = 0;
  double pairs_per_step = 0;  // of the node that has most
  ExpectedCycles expected;    // hw/cost/cycles.h
  std::optional<MachineCounts> counts;
  bool screened = false;  // counted for fewer steps than the study's: what it is good for is a guess
  std::vector<MachineValue> values;  // by measure (measure_names)
  std::vector<MachineValue> kept;    // by constraint, of fits: the share
  std::vector<std::string> lacking;  // constants that the technology has no figure of

  bool done() const { return why.empty(); }
  const MachineValue& value(MachineQuantity quantity) const { return values[static_cast<size_t>(quantity)]; }
};

// The worst verdict of all constraints.
Verdict verdict_of(const MachineStudy& study, const MachineFinding& finding);

struct MachineRunnerOptions {
  std::string kept;  // a file of counts, read and added to; empty: none
  int jobs = 0;      // 0: one per core
  bool progress = true;
  EstimateDevice device;  // may be empty
};

// Counts are kept as they come: the same calls after a kill give the same findings to the last bit. Throws
// Interrupted (study/sweep/interrupted.h).
class MachineRunner {
 public:
  MachineRunner(const MachineStudy& study, MachineRunnerOptions options);

  // In their order. `steps`: that are counted; fewer than the study's make screened findings.
  std::vector<MachineFinding> evaluate(const std::vector<MachineChoice>& choices, uint64_t steps);
  // Adds the errors of the machines that are done; nothing without figures.
  void add_errors(std::vector<MachineFinding>& findings, Runner& errors) const;

  size_t counted() const { return counted_; }  // machines whose steps this runner has counted itself

 private:
  struct Kept {
    std::optional<MachineCounts> counts;  // none: the first step breaks something
  };
  std::optional<Kept> kept(const std::string& key);
  void keep(const std::string& key, const Kept& kept);
  void find(const std::vector<size_t>& group, uint64_t steps, std::vector<MachineFinding>& findings);
  void judge_all(MachineFinding& finding) const;

  const MachineStudy& study_;
  MachineRunnerOptions options_;
  std::map<std::string, Kept> counts_;
  std::optional<KeptLines> lines_;
  std::mutex mutex_;
  size_t counted_ = 0;
};

}  // namespace cuboct::study
