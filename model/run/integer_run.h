// SPDX-License-Identifier: MIT
// A rule that is text, in integers: golden steps it, and its terms in doubles tell forces, energies and
// fields of the states that are looked at.
#pragma once

#include "model/contract/golden.h"
#include "model/program/integer_program.h"
#include "model/run/rounds_run.h"

namespace cuboct {

// Where a program's integers stand: references that outlive the engine.
struct ProgramSetting {
  const IntegerProgram& program;
  const FixedRule& fixed;
  const Lattice& lattice;
  const Vec3& origin;
  int capacity = 0;
};

class IntegerRun final : public RoundsRun {
 public:
  // Throws as Golden does. `step`: of `body`, which has what the rule's fields kept.
  IntegerRun(const Scene& scene, const Body& body, const ProgramSetting& setting, uint64_t step = 0);

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override;
  uint64_t hash() override;
  Momentum momentum() override;
  Counters counters() override;
  Notes notes() override;

 private:
  void renew() override;
  State state_of(const Body& body) const;

  ProgramSetting setting_;
  Golden golden_;
};

}  // namespace cuboct
