// SPDX-License-Identifier: MIT
// The arithmetic of a plan as data: which products, adders and tables a pair, a lane's test and an update
// use. Area (hw/cost/node_area.h) and energy (hw/cost/energy.h) stand on the same numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/plan/plan.h"

namespace cuboct {

inline constexpr int kScaleBits = 18;  // of the multiplicand that a pair's scale or weight is, in rtl/lib

// Multiplications of two's complement numbers.
struct Product {
  int a = 0, b = 0;  // bits of the operands
  int count = 1;     // of such products
  bool operator==(const Product&) const = default;
};

// Entries read of a table of constants.
struct TableWords {
  uint64_t words = 0;  // that the table holds
  int bits = 0;        // of an entry, all coefficients together
  int count = 1;       // reads
  bool operator==(const TableWords&) const = default;
};

// One use of a part of the datapath.
struct Work {
  std::vector<Product> products;
  double adder_bits = 0;  // of adders, subtractors and comparators, summed
  std::vector<TableWords> tables;
  double register_bits = 0;  // of pipeline registers that one use writes, at least

  double bit_products() const;  // sum of a b count
  double table_bits() const;    // that the tables hold
};

struct DatapathWork {
  Work pair;    // from the positions of a pair to its kick in a sum
  Work kick;    // of that what a pair beyond the cutoff leaves out; nothing of rules of text
  Work lane;    // one candidate against one own particle
  Work update;  // of one particle
  Work cull;    // with halos on arrival: of one record, against the box of the own particles
};

// `built`: as rtl/lib computes it, z left out of flat plans. `cost`: what the cost of a study counts, so that
// costs of different plans compare: three axes, and lanes that test whole differences.
enum class WorkOf : uint8_t { built, cost };
DatapathWork datapath_work(const Plan& plan, WorkOf of = WorkOf::built);

// Bits of two's complement that hold every value of a table: ForceBits, DampBits of the RTL.
int value_bits(const FixedTable& table);
// Of a pipe's exact kick, and of the sum of all kicks that a particle can get; one axis.
int kick_bits(const FixedRule& rule);

}  // namespace cuboct
