// SPDX-License-Identifier: MIT
// A rule's text understood: every formula is part of a graph. In SI units, in doubles.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/program/point_table.h"
#include "model/program/real_graph.h"
#include "model/program/rule_text.h"
#include "model/rules/declaration.h"
#include "model/rules/reference_bonds.h"

namespace cuboct {

// Fields and sums are counted in numbers, one after another: a vector has three.
struct ProgramField {
  std::string name;
  Value::Kind kind = Value::Kind::number;
  uint32_t first = 0;                                // of its numbers
  bool kept = false;                                 // goes on from step to step
  bool shown = true;                                 // in frames
  std::optional<std::pair<double, double>> range{};  // SI
  double resolution = 0;                             // SI, of integers at most; 0: as fine as they are
  std::vector<NodeId> start{};                       // of the graph of starts
  uint32_t numbers() const { return kind == Value::Kind::vector ? 3 : 1; }
};

// A number that a node gives.
struct ProgramWrite {
  uint32_t number = 0;
  NodeId node = 0;
};

struct ProgramRound {
  std::string name;
  RealGraph pair;                   // of one particle and one bond of it
  std::vector<NodeId> terms;        // by number of the sums
  std::vector<NodeId> when;         // the same: the truth that lets a term count
  std::vector<ProgramWrite> bonds;  // before the terms, which see what was written
  RealGraph finish;                 // of one particle
  std::vector<ProgramWrite> made;   // by number of the particle fields
};

struct RuleProgram {
  RuleDeclaration declaration;
  double reach = 0;      // m
  double core = 0;       // m; 0: the rule is no pair law
  double stiffness = 0;  // N/m; 0: unknown
  bool still = false;
  std::vector<ProgramField> particle, bond;
  uint32_t particle_numbers = 0, bond_numbers = 0;
  uint32_t force = 0;           // the first number of the force; not where still
  RealGraph start, bond_start;  // of the fields' starts
  std::vector<ProgramRound> setup, rounds;
  // Of a bond: J, half of each particle; whether it is broken. Of a particle: J.
  RealGraph pair_energy, particle_energy, broken;
  std::optional<NodeId> pair_energy_at, particle_energy_at, broken_at;
  std::vector<DeclarationLine> settings;
  std::shared_ptr<const EmbeddedAtoms> potential;         // whose tables the graphs refer to; may be null
  std::vector<std::shared_ptr<const PointTable>> tables;  // the rule's own, the same
  // Of noise the first step is this one: those before it belong to the runs that this one goes on from.
  uint64_t first_step = 0;
  // By type of particles 2^k of the k-th element of the potential; empty: all are the first.
  std::vector<double> element;
  bool shows_damage = false;  // the last of the declaration's `shown` is the share of bonds that are broken
  std::vector<Slit> slits;    // that bonds of the body as packed do not pass
  // By number of the regions that starts name, whether one holds a place (m, as packed); empty: of others.
  std::vector<std::function<bool(const Vec3&)>> regions;
};

// What the scene gives a rule.
struct ProgramPlace {
  double pitch = 0;                       // m, of the packing; 0: there is none
  std::vector<std::string> regions = {};  // names
};

// The regions that starts name, by number.
std::vector<uint32_t> regions_of_starts(const RuleProgram& program);

// InputError, with its place, where the text does not hold together.
RuleProgram understood(const RuleText& text, const ProgramPlace& place);

}  // namespace cuboct
