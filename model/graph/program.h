// SPDX-License-Identifier: MIT
// A rule as a program of integers: what a particle holds, and of each round two graphs. That of a pair says
// whether it counts and what it adds to the sums of its own particle; the finish makes fields of the sums,
// and in the last round the motion.
//
// To make one: fill formats, fields and constants; for each round build the pair's graph with a Builder and
// the read_* functions below, name its `when` and terms; then the finish, which reads the sums.
// check(program) holds it together.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/graph/builder.h"
#include "model/graph/graph.h"
#include "model/graph/parity.h"

namespace cuboct::graph {

// `numbers` integers of a particle, or of a bond, kept from round to round and from step to step.
struct Field {
  std::string name;
  int numbers = 1;
  Interval range{};
  int frac = 0;
};

// Numbers that never change: one for each type, or for each pair of types (own * types + other).
struct Constants {
  std::string name;
  std::vector<int64_t> values;
  int frac = 0;
};

// A number that a bond has for ever (BondRows). `parity`: what its other end has: the same, the negative, or
// anything.
struct BondConstant {
  std::string name;
  Interval range{};
  int frac = 0;
  Parity parity = Parity::none;
};

struct Sum {
  std::string name;
  std::vector<int> terms;  // nodes of the pair's graph, one for each component
};

// The node whose value becomes a component of a field.
struct Write {
  int field = 0, component = 0, node = 0;
};

struct Round {
  std::string name;
  Graph pair = {};
  int when = -1;  // truth: the pair counts
  std::vector<Sum> sums = {};
  std::vector<Write> bond_writes = {};  // by the pair's graph
  Graph finish = {};
  std::vector<Write> writes = {};  // by the finish

  int numbers() const;       // of all sums
  int place(int sum) const;  // of a sum's first number among them
};

// Nodes of the last finish, one for each axis. x += drift, P+G fractional bits.
struct Motion {
  std::vector<int> v, u, drift;  // u may be empty: then no particle has a displacement
};

struct FixedProgram {
  std::string name;
  int axes = 3;
  int types = 1;
  int partners = 0;                  // of a particle, at most: 27 capacity - 1, or those of the longest row
  int position_frac = 0, guard = 0;  // P, G
  Interval velocity{}, displacement{};
  std::vector<Field> fields;
  std::vector<Constants> type_constants, pair_constants;
  // Partners are those of BondRows, wherever they are among the 27 cells; else all particles of these.
  bool bonded = false;
  std::vector<Field> bonds;  // what rounds write of a bond
  std::vector<BondConstant> bond_constants;
  // Of a bond alone: the truth that it counts no more, for ever. Such a bond may be of any length, and keeps
  // its numbers where its partner is in none of the 27 cells. -1: all bonds count.
  Graph broken;
  int broken_at = -1;
  std::vector<Round> rounds;
  Motion motion;

  int numbers() const;                 // of all fields of a particle
  int place(int field) const;          // of a field's first number among them
  int bond_numbers() const;            // of all fields of a bond
  int bond_place(int field) const;     // as place()
  bool symmetric(int constant) const;  // of a pair constant: types may be swapped
};

// What the numbers of these fields begin with where nobody says: zero, or the end of the range next to it.
std::vector<int64_t> beginning_of(const std::vector<Field>& fields);

// The nodes that a round's graphs are run for: the components of all sums, in order; of a pair, these and
// what it writes of its bond; of the finish, what it writes and, of the last round, the motion.
std::vector<int> terms_of(const Round& round);
std::vector<int> pair_outputs(const Round& round);
std::vector<int> finish_outputs(const FixedProgram& program, const Round& round);

// Whether any term depends on the number of the step, as noise does.
bool reads_step(const FixedProgram& program);
// Whether a step may change a position: else no particle ever leaves its cell.
bool moves(const FixedProgram& program);

// Inputs with the range that the program gives them.
int read_apart(Builder& b, const FixedProgram& program, int axis);
int read_velocity(Builder& b, const FixedProgram& program, Source source, int axis);
int read_displacement(Builder& b, const FixedProgram& program, int axis);
int read_constant(Builder& b, const FixedProgram& program, Source source, int constant);
int read_field(Builder& b, const FixedProgram& program, Source source, int field, int component = 0);
int read_bond(Builder& b, const FixedProgram& program, int field, int component = 0);
int read_bond_constant(Builder& b, const FixedProgram& program, int constant);
// In the finish of `round`, whose pair graph is there.
int read_sum(Builder& b, const FixedProgram& program, const Round& round, int sum, int component = 0);

// What `partners` terms add up to, in any order and in each partial sum.
Interval summed(Interval term, int partners);

// Throws std::logic_error, with the name, where the program does not hold together: a node that is not there,
// a `when` that is no truth or needs a check, a write that may leave its field, a motion beyond its format, a
// bond that its two ends would write differently.
void check(const FixedProgram& program);

}  // namespace cuboct::graph
