// SPDX-License-Identifier: MIT
// A rule of several rounds in doubles: its declaration, and the terms that an engine runs by it.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/base/mat3.h"
#include "model/contract/rule.h"
#include "model/rules/declaration.h"

namespace cuboct {

// A state of which the rounds cannot be run: a position that is not finite, a table that ends before what it
// is asked for.
class RoundsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The rule on the particles of one body. A row is what one particle does: the rows of [begin, end) are done
// in ascending order by one thread, others at the same time, and a row writes what is of its particle alone.
// So no bit depends on threads.
class RoundsTerms {
 public:
  virtual ~RoundsTerms() = default;

  // The box is this one from the next begin() on: of the same axes, and of a rule that lets_box_deform().
  virtual void set_box(const Periodic&) {}
  // Before the first round, from the positions, m by id, in no image: what the declaration calls `ready`.
  // std::runtime_error where a position is not finite.
  virtual void begin(const std::vector<Vec3>& x) = 0;
  // Before begin(), for terms that read them: m/s, by id, half a step before the positions.
  virtual void velocities(const std::vector<Vec3>&) {}
  // Before begin(), for terms that draw noise: how many steps led to the positions.
  virtual void time(uint64_t) {}
  // The pair term of a round, which sums over a particle's bonds by ascending id of the other. With `keeps`
  // the bonds' own fields change: a step was made; else the state is only looked at.
  virtual void pair(size_t round, size_t begin, size_t end, bool keeps) = 0;
  virtual void finish(size_t round, size_t begin, size_t end) = 0;
  // After all rows of a round, by one thread: what the finish made is there for the next one.
  virtual void end(size_t, bool) {}
  // N, on each particle, by the last round.
  virtual const std::vector<Vec3>& force() const = 0;

  // By what the last rounds left. J, or RoundsError; Pa, tension positive, over `volume` (m^3).
  virtual double energy() const = 0;
  virtual Mat3 stress(size_t particle, double volume) const = 0;
  // Of each particle's bonds the share that is broken, 0 to 1; empty: none breaks. How many bonds there are
  // (each once).
  virtual std::vector<double> damage() const { return {}; }
  virtual uint64_t bonds() const = 0;
  // What the declaration's `shown` names, in its order: [field][particle x its numbers].
  virtual std::vector<std::vector<double>> shown() const { return {}; }

  // The bonds' own fields, as a checkpoint keeps them. recall(): InputError where they are another body's.
  virtual std::vector<uint64_t> memory() const { return {}; }
  virtual void recall(const std::vector<uint64_t>&) {}
  // Of what decides what memory() means: the bonds that there are, and the law by which they give way.
  virtual uint64_t memory_hash() const { return 0; }
};

// All rounds on all particles, one round after another, from what begin() was given: none begins before all
// particles have finished the one before it.
void run_rounds(RoundsTerms& terms, size_t rounds, size_t particles, bool keeps, int threads = 1);

struct RuleProgram;  // model/program/rule_program.h

class RoundsRule {
 public:
  virtual ~RoundsRule() = default;

  // Of a rule that is text; null: it is written in C++.
  virtual const RuleProgram* text() const { return nullptr; }

  virtual const RuleDeclaration& declaration() const = 0;
  // The chemical element whose atoms the particles are; empty: none.
  virtual std::string element() const { return {}; }
  // Whether the box may change its lengths while the rule runs.
  virtual bool lets_box_deform() const { return false; }
  // m, beyond which the bond of two nearest neighbours is broken; infinite where none breaks.
  virtual double bond_reach() const = 0;
  // s, the largest stable time step of an undamaged body; 0 where it is not known.
  virtual double stable_time_step(double mass, double pitch) const = 0;
  // N/m, of the stiffest motion of a particle; 0 where it is not known.
  virtual double stiffness() const = 0;
  // m/s, of the fastest long wave in matter of particles of this mass; 0 where it is not known.
  virtual double sound_speed(double mass) const = 0;
  // What sets it apart from another, in SI units: for people, and for the hash of a run.
  virtual std::vector<DeclarationLine> settings() const = 0;
  // InputError where the body does not fit: a particle with too few bonds, ...
  // `rule`: with masses and the time step.
  virtual std::unique_ptr<RoundsTerms> bind(const Rule& rule, const Body& body, const Periodic& periodic,
                                            int threads) const = 0;
};

// Whether bonds are those of the body as packed: a body that has moved must say where that was.
bool has_reference_bonds(const Rule& rule);
// Whether bonds keep what they went through: a body that goes on must bring it.
bool has_bond_memory(const Rule& rule);
// Whether bonds or particles keep something: a state without it is no state of the rule.
bool has_memory(const Rule& rule);
// Whether its particles move.
bool moves(const Rule& rule);
// The body with Body::bonds, where the rule's are those of the body as packed or the rule has a memory: those
// of `start`, or, where it has none, of where its particles are.
Body with_bonds(const Rule& rule, Body body, const Body& start);

// Body::bonds of the terms, where the body has them, and back. recall_bonds: InputError where the bonds are
// others, or give way by another law.
void keep_bonds(Body& body, const RoundsTerms& terms);
void recall_bonds(RoundsTerms& terms, const Body& body);

// InputError where the rule has rounds, of `who` that knows pairs alone: "the lattice engine".
void refuse_rounds(const Rule& rule, const std::string& who);

}  // namespace cuboct
