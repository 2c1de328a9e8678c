// SPDX-License-Identifier: MIT
// What compiled code of a rule is given: plain data. The code includes this file too.
//
// A rule's shape (which operation takes what) is code. Its numbers (constants, roundings, tables) are data,
// so that rules of one shape share their code.
#pragma once

#include <cstdint>

#include "emu/lattice/entry.h"

namespace cuboct::emu {

// A table as vectors read it (VectorTable); its words may be packed (is_packed).
struct CodeTable {
  const uint64_t* words;
  const double* c2;  // of parabolas
  int64_t index_shift, index_mask, index_bits, index_base;
  int64_t t_mask;
  double factor;     // of a rounding by the bits of t, in units of t_mask
  int64_t low_mask;  // of packed words: c0 plus half of this
  double bias;       // kMagic and that half
};

// What a rule's text says in numbers.
struct CodeNumbers {
  const double* constants;
  const int64_t* seeds;
  const CodeTable* tables;
  const double* const* type_constants;  // [constant][type]
  const double* const* pair_constants;  // [constant][own * types + other]
  int64_t types;
};

// A round's pairs over some groups of a block. Arrays are by index of a particle unless said otherwise, and
// readable a group beyond either end.
//
// Sums have kMagic added (kernel_rule.h). Of a list whose groups are all of the block's, that of particle p
// stands at (p - begin) & mask: a ring, that holds kEntryLanes more behind its end for entries that overhang
// it. Of an edge, whose groups are `group_of`, the g-th group's stand from g * kEntryLanes on.
struct Job {
  CodeNumbers numbers;
  double step;
  const double* x[3];
  const double* v[3];
  const double* const* fields;  // by number
  const uint8_t* type;
  const uint32_t* id;        // null: the index is the id
  const double (*shift)[3];  // Particles::shift
  uint32_t begin;            // the block's first particle
  double* const* sums;       // by term
  uint32_t mask;

  const Entry* entries;
  const EntryGroup* groups;
  const uint32_t* group_of;  // of an edge: the block's groups that have entries; else null
  // Which of `groups` to work on: `chosen`, or, where that is null, those from `first` on.
  const uint32_t* chosen;
  uint32_t first, count;
  const uint8_t* wanted;  // of these the wanted ones, by group of the block; null: all

  // Of a bonded program. A slot is entry * kEntryLanes + lane.
  double* const* bonds;          // [number][slot]
  const uint32_t* kind;          // [slot]
  const double* bond_constants;  // [kind * bond_constant_count + constant]
  int64_t bond_constant_count;
  double cell;  // ends nearer than that along each axis are in neighbouring cells

  void* owner;
  // Of ends that are not so near: whether they meet. Then `apart` becomes that of their images.
  bool (*meet)(void* owner, uint32_t own, uint32_t other, uint64_t slot, double apart[3]);
  // A bond of these two has another number; null: nobody asks.
  void (*changed)(void* owner, uint32_t own, uint32_t other);
  // A check of this pair found what does not fit. Its bond is not written yet.
  void (*misfit)(void* owner, uint32_t own, uint32_t other, const Entry& entry, uint64_t slot);
};

// The particles' ends of each entry: the terms go to the sums of the lower one, of the other one, or of both.
using MeetCode = void (*)(const Job&);

// A round's finish over some groups of a block: arrays and groups as above.
struct FinishJob {
  CodeNumbers numbers;
  double step;
  double* x[3];
  int32_t* residue[3];
  double* v[3];
  double* u[3];  // null: nobody has a displacement
  double* const* fields;
  const uint8_t* type;
  const uint32_t* id;
  uint32_t begin, end;
  const double* const* sums;
  uint32_t mask;
  const uint32_t* chosen;
  uint32_t first, count;
  const uint32_t* cell;
  const uint8_t* awake;  // by cell; null: all
  double edge, inverse_edge, guard, inverse_guard;

  void* owner;
  void (*changed)(void* owner, uint32_t particle);  // null: nobody asks
  void (*crossed)(void* owner, uint32_t particle, const int8_t away[3]);
  // Some of so many particles has a check that failed. None of them is written.
  void (*misfit)(void* owner, uint32_t first, uint32_t count);
  double* fastest2;  // the largest v.v so far
};

// Writes fields of awake particles and, in the last round, moves them.
using FinishCode = void (*)(const FinishJob&);

}  // namespace cuboct::emu
