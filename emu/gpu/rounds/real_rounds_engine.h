// SPDX-License-Identifier: MIT
// A rule that is text in floats or doubles on GPUs: the graphs that the reference runs, a thread for each
// particle. Positions are integers, so that a step adds to them exactly. No bit depends on how many devices
// share a scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "emu/gpu/engine.h"
#include "emu/gpu/rounds/rounds_engine.h"
#include "model/contract/rule.h"
#include "model/program/rule_program.h"

namespace cuboct::gpu {

// What the rounds make of the state at hand, without a step. SI, by id.
struct RealLook {
  std::vector<Vec3> force;                  // N; empty of a rule that moves nothing
  std::vector<std::vector<double>> fields;  // [number of the rule's fields][particle]; not of the force
};

class RealRounds {
 public:
  virtual ~RealRounds() = default;

  // LostPosition where a position leaves all bounds, TableEnds where a table is asked for more than it has:
  // the state before that step stands. Returns early, after a complete step, where model/base/interrupt.h
  // says so.
  virtual void advance(uint64_t steps) = 0;
  virtual uint64_t step_count() const = 0;
  virtual void read(Body& body) const = 0;  // x, v, and u where it has one: by id, not wrapped
  virtual RealLook look() = 0;
  // As RoundsTerms::memory.
  virtual std::vector<uint64_t> kept() const = 0;
  // What another one of the same scene goes on from with the same bits.
  virtual std::vector<uint64_t> memory() const = 0;
  virtual cuboct::Counters counters() const = 0;
  virtual std::string kernels() const = 0;  // how they were made
};

class TableEnds : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// `body`: with Body::bonds, and with u where a type is held by force. `doubles`: else floats. `compile` as of
// make_rounds_engine: nothing is interpreted. InputError where it fails, or the rule needs more than a thread
// has; std::runtime_error where CUDA fails. Keeps a reference to the rule, which is text.
std::unique_ptr<RealRounds> make_real_rounds(const Rule& rule, const Body& body, const Periodic& periodic,
                                             bool doubles, const Options& options,
                                             const CompileRounds& compile, const Memory& memory = {});

}  // namespace cuboct::gpu
