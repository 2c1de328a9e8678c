// SPDX-License-Identifier: MIT
// A graph of integers (model/graph/graph.h) taken apart into steps that hardware has: adders, choices,
// products of at most 18 by 18 bits, memories. docs/reference/pipeline.md says how each operation is.
#pragma once

#include <cstdint>
#include <vector>

#include "model/graph/graph.h"

namespace cuboct::pipeline {

// a, b, c: the steps' inputs in order, extended by their own signs. Results are taken modulo 2^bits.
enum class Kind : uint8_t {
  constant,    // `number`
  input,       // a port
  slice,       // a / 2^low, rounded down
  join,        // a above all bits of b
  add,         // a + b, and + c where there is a third input of one bit
  sub,         // a - b
  less,        // a < b
  less_equal,  // a <= b
  equal,       // a == b
  both,        // of bits: a and b
  either,      // a or b
  negate,      // not a
  choose,      // a ? b : c
  exclusive,   // a xor b, bit by bit
  leading,     // number of zeros above the leading one of a, which has 2^n bits; any number where a is 0
  shift_left,  // a 2^b
  carry,       // what rounding a / 2^low adds to the slice: 0 or 1, halves away from zero
  unfit,       // 1 where a is not what its lowest `low` bits, signed, are
  product,     // a b, of at most 18 bits each; a block with a register behind it
  rom,         // entry a of `table`: c2, c1, c0 from the top; a block with two registers
};
inline constexpr int kKinds = static_cast<int>(Kind::rom) + 1;
// Bits of a product's inputs, with a sign; those of a limb without one.
inline constexpr int kFactorBits = 18, kLimbBits = kFactorBits - 1;
// A factor of so many bits is multiplied by adders: a device has a thousand LUTs for each multiplier.
inline constexpr int kNarrowBits = 3;

struct Step {
  Kind kind = Kind::constant;
  std::vector<int> inputs{};  // earlier steps
  int bits = 1;
  bool is_signed = false;
  int low = 0;
  uint64_t number = 0;  // two's complement in `bits`
  int table = -1;
  int node = -1;  // of the graph: the first that asked for this step
};

struct Port {
  int step = 0, node = 0;
};

struct Steps {
  std::vector<Step> steps;
  std::vector<Port> inputs;   // by their nodes' order
  std::vector<Port> outputs;  // as they were asked for
  std::vector<int> of_node;   // the step that is a node's value; -1: nothing needs it
  // Of the checks: whether one fails, and its fault and number: the least fault, of equal ones the first
  // node's. -1: there are no checks.
  int fault = -1, fault_code = -1, fault_number = -1;
};

// A value of `bits` bits, by its interval: without a sign bit where it is never negative.
struct Form {
  int bits = 1;
  bool is_signed = false;
  bool operator==(const Form&) const = default;
};
Form form_of(graph::Interval range);

// Bits of the entries of a table in its memory.
struct EntryForm {
  int c0 = 1, c1 = 1, c2 = 0;  // signed; c2 0 at degree 1
  int bits() const { return c0 + c1 + c2; }
};
EntryForm entry_form(const FixedTable& table);

// A step that moves bits and takes no time.
inline bool is_wire(Kind kind) { return kind == Kind::constant || kind == Kind::slice || kind == Kind::join; }

// The steps of all nodes that `outputs` need. A `within` passes its input on, so that where the graph's pair
// does not count values are any.
Steps steps_of(const graph::Graph& graph, const std::vector<int>& outputs);

}  // namespace cuboct::pipeline
