// SPDX-License-Identifier: MIT
// A rule's arithmetic as data: integers, total operations, and of each value an interval that is proven.
// docs/reference/graph.md defines every operation; Builder (builder.h) makes graphs, Block (interpret.h) runs
// them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/base/error.h"
#include "model/graph/fixed_table.h"

namespace cuboct::graph {

// a, b, c: the values of the inputs in order. Truths are 0 and 1.
enum class Op : uint8_t {
  constant,  // `number`
  input,     // what `source`, `index` and `axis` name
  add,       // a + b
  sub,       // a - b
  neg,       // -a
  shl,       // a 2^shift
  round,     // round_odd(a, shift)
  floor,     // floor(a / 2^shift)
  mul,       // round_odd(a b, shift)
  mac,       // a + round_odd(b c, shift)
  dot,       // round_odd(sum a_k b_k, shift); inputs: all a_k, then all b_k
  lookup,    // entry of `table`: a the argument, b the law's number (FixedTable)
  lt,        // a < b
  le,        // a <= b
  eq,        // a == b
  both,      // truths: a and b
  either,    // a or b
  negate,    // not a
  select,    // a ? b : c
  min,       // the lesser of a, b
  max,       // the greater of a, b
  abs,       // |a|
  clamp,     // a, or the nearer end of `range`
  within,    // as clamp; where the pair counts a lies in `range`, so an engine may take a as it is
  msb,       // floor(log2 a); -1 where a <= 0
  align,  // a, shifted so that its leading bit is bit `shift`; with width 2 so that its bits are shifted by
          // an even number and the leading one is bit `shift` or the one above. 0 where a <= 0
  shift,  // a 2^b; round_odd(a, -b) where b < 0
  check,  // a wrapped to `width` bits; a fault with the number a where that changes it and b holds
  noise,  // `width` bits, signed and uniform, mixed of `number` (the seed), {a, b} without order, c
};

// What an input reads. In the graph of a pair, own is the particle that sums and other its partner.
enum class Source : uint8_t {
  apart,           // other's visible position less own, along `axis`; P fractional bits. Odd.
  own_x,           // P+G fractional bits, in a finish alone: [0, 2^(P+G))
  own_v,           // P+G fractional bits
  other_v,         //
  own_u,           // displacement from the anchor, in a finish alone
  own_constant,    // type constant `index` of own's type
  other_constant,  // of other's type
  pair_constant,   // pair constant `index` of both types
  own_field,       // particle field `index`, component `axis`
  other_field,     //
  bond_field,      // of the bond of both; both ends hold the same
  bond_constant,   // bond constant `index` of the bond of both, as own's end has it
  sum,             // sum `index` of this round, component `axis`; in a finish alone
  own_id,          //
  other_id,        //
  step,            // number of the step
};

// Both ends are possible values.
struct Interval {
  int64_t low = 0, high = 0;
  bool operator==(const Interval&) const = default;
  bool holds(int64_t v) const { return low <= v && v <= high; }
};

struct Node {
  Op op = Op::constant;
  std::vector<int> inputs{};  // indices of earlier nodes
  int64_t number = 0;
  int shift = 0;
  int width = 0;
  int table = -1;
  Fault fault = Fault::none;
  Source source = Source::apart;
  int index = 0, axis = 0;
  bool symmetric = false;  // of a pair constant: swapped types give the same; of a bond's: both ends do
  bool opposite = false;   // of a bond constant: the other end has the negative
  Interval range{};        // every value lies in it
  int frac = 0;            // the value means v / 2^frac; for reports
  std::string name{};      // for reports

  // Whether both make the same value: all but range, frac and name. Ranges count where they are the
  // operation.
  bool same_as(const Node& other) const;
};

struct Graph {
  std::vector<Node> nodes;  // inputs before those who use them
  std::vector<FixedTable> tables;
};

const char* to_string(Op op);
const char* to_string(Source source);
// "r2", or "mul 12" where the node has no name.
std::string label(const Graph& graph, int node);
// The nodes that these need, themselves among them, in order.
std::vector<int> needed_by(const Graph& graph, const std::vector<int>& nodes);

// Values are at most 63 bits wide. What is rounded may take 64, together with the half that is added to it.
inline constexpr Interval kWidest{-(int64_t{1} << 62), (int64_t{1} << 62) - 1};

// Whether doubles hold all that happens in a graph: products below 2^52, values below 2^51, sums of products
// on their way below 2^53.
struct Exactness {
  bool doubles = true;  // class A; else B, 64-bit integers alone
  int worst = -1;       // of class B the first node that doubles do not hold
};
Exactness exactness_of(const Graph& graph);

}  // namespace cuboct::graph
