// SPDX-License-Identifier: MIT
// Judges a node's RTL, changed or not, by one case: golden's bits, the native node's cycles, golden's fault,
// without stalls and with.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "emu/verilated/library.h"
#include "tests/backend/engines.h"
#include "tests/support/cases.h"

namespace cuboct::test {

// `name` of make_case, random_<seed>, random_flat_<seed>, fault_<code> or small_<name of small_case>. Throws
// std::out_of_range.
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
  bits,       // a state, an order of slots or a hash differs from golden's
  fault,      // stops where golden does not, or otherwise
  cycles,     // a phase begins or ends in another cycle than the native node's
  assertion,  // of the RTL
  stuck,      // no phase begins or ends any more: the bench's own limit
  error       // a word that cannot be: a particle of another node's id, a step out of order
};
const char* to_string(Verdict verdict);

struct Judgement {
  Verdict verdict = Verdict::passed;
  std::string text;  // the first difference
  uint64_t steps = 0, particles = 0, spans = 0;  // compared
};

class Judge {
 public:
  // A run to judge by: the stalls of the links, and what the registers hold before reset (emu/verilated).
  struct Run {
    double stall_rate = 0;
    uint64_t stall_seed = 1;
    uint32_t register_seed = 0;
  };
  // Runs golden and the native node once per run.
  Judge(Case c, std::vector<Run> runs);
  // Throws std::bad_alloc where the run shows more and more.
  Judgement judge(const std::shared_ptr<const emu::Library>& library) const;

  const Case& of() const { return case_; }
  const GoldenRun& golden() const { return golden_; }
  // The native node's run number `k`; its counters tell what the case does.
  const emu::RunResult& native(size_t k) const { return native_[k]; }

 private:
  const Case case_;
  const std::vector<Run> runs_;
  const GoldenRun golden_;
  std::vector<emu::RunResult> native_;
};

// Without stalls from zeros, and with three cycles of ten stalled from random registers.
std::vector<Judge::Run> usual_runs();

}  // namespace cuboct::test
