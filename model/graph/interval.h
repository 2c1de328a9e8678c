// SPDX-License-Identifier: MIT
// The interval of a value from those of its inputs: bottom up, one rule for each operation.
#pragma once

#include <vector>

#include "model/graph/graph.h"

namespace cuboct::graph {

__extension__ typedef __int128 Wide;

struct WideInterval {
  Wide low = 0, high = 0;
};

// Of the value of `node`, which reads values of these intervals. Nodes that have a range by themselves
// (constant, input, noise) keep it.
WideInterval range_of(const Node& node, const std::vector<Interval>& inputs, const FixedTable* table);
// Of what a product is before it is rounded, sums of products included; of other operations {0, 0}.
WideInterval product_of(const Node& node, const std::vector<Interval>& inputs);

// All entries that an argument and laws in these intervals reach. Of lines the ends are values of the table.
// Of a parabola with its vertex inside a bin they are at most two units beyond.
WideInterval range_of(const FixedTable& table, Interval argument, Interval law);
// How many laws the table holds.
int64_t laws_of(const FixedTable& table);
// The arguments that the table is made for: [0, 2^(2D)).
Interval domain_of(const FixedTable& table);

}  // namespace cuboct::graph
