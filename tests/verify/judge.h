// SPDX-License-Identifier: MIT
// Judges a node's RTL, changed or not, by one case: golden's bits, golden's fault, the native node's ports in
// each cycle; without stalls and with, and where links are checked with faults on the wires.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "emu/verilated/library.h"
#include "tests/backend/engines.h"
#include "tests/support/cases.h"
#include "tests/verify/ports.h"

namespace cuboct::test {

// `name` of make_case, random_<seed>, random_flat_<seed>, fault_<code> or small_<name of small_case>. A case
// that faults ends with the step that does. Throws std::out_of_range.
Case case_of(const std::string& name);

struct NodeBuild {
  // Directory whose *.sv take the place of those of the same name, and whose others are read before all.
  std::string changed;
  std::string optimise = "-O2";
  bool coverage = false;  // counts lines; each node writes a file into $CUBOCT_COVERAGE when it goes
};
// Compiles (or finds) the node. What is changed may ask for the mutant to be: the number in $CUBOCT_MUTANT
// when a node is made, 0 without one (`import "DPI-C" function int cuboct_mutant_asked()`).
std::string build_node(const Plan& plan, const NodeBuild& build, const std::string& cache);

// How a mutant was seen, or that it was not.
enum class Verdict {
  passed,
  bits,    // a state, an order of slots or a hash differs from golden's, an observed particle from the native
           // node's
  fault,   // stops where golden does not, or otherwise
  cycles,  // a phase begins or ends in another cycle than the native node's, or its engine did other work
  links,   // a beat, an acknowledgement or a link's error differs from the native node's
  assertion,  // of the RTL
  stuck,      // no phase begins or ends any more: the bench's own limit
  error       // a word that cannot be: a particle of another node's id, a step out of order
};
const char* to_string(Verdict verdict);

struct Judgement {
  Verdict verdict = Verdict::passed;
  std::string text;                                          // the first difference
  uint64_t steps = 0, particles = 0, spans = 0, cycles = 0;  // compared; cycles of nodes, port by port
};

class Judge {
 public:
  // A run to judge by.
  struct Run {
    double stall_rate = 0;  // of the links
    uint64_t stall_seed = 1;
    uint32_t register_seed = 0;       // what the registers hold before reset (emu/verilated)
    std::optional<uint64_t> steps{};  // other than the case's
    bool mixed = false;               // every second node is a native one
    emu::FaultOptions faults{};       // on the wires
  };
  // Runs golden and the native node once per run.
  Judge(Case c, std::vector<Run> runs);
  // Throws std::bad_alloc where the run shows more and more.
  Judgement judge(const std::shared_ptr<const emu::Library>& library) const;

  const Case& of() const { return case_; }
  const GoldenRun& golden() const { return golden_; }
  // The native node's run number `k`; its counters tell what the case does.
  const emu::RunResult& native(size_t k) const { return native_[k]; }
  size_t runs() const { return runs_.size(); }

 private:
  emu::RunOptions options_of(const Run& run) const;
  const Case case_;
  const std::vector<Run> runs_;
  const GoldenRun golden_;
  std::vector<emu::RunResult> native_;
  std::vector<PortRecord> ports_;  // the native node's
};

// Without stalls from zeros, with three cycles of ten stalled from random registers, and of no step. Checked
// links also meet native neighbours, and faults of each kind: many with retry, single ones with detect.
std::vector<Judge::Run> usual_runs(const Plan& plan);

}  // namespace cuboct::test
