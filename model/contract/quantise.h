// SPDX-License-Identifier: MIT
// From a rule in doubles to one in integers.
#pragma once

#include <limits>

#include "model/contract/fixed_rule.h"
#include "model/contract/rule.h"

namespace cuboct {

// How to tabulate; an arch file may set each of them.
struct TableChoice {
  enum class Shape : uint8_t { automatic, uniform, octaves };
  Shape shape = Shape::automatic;  // automatic: the shape with the smaller worst force error
  int degree = 1;                  // 1 or 2
  int index_bits = 0;              // 2^index_bits entries; 0: chosen, see quantise
  int fraction_bits = 17;
};

// `widths.strength_bits` = 0 takes the least width from 18 (a multiplier of small FPGAs) to 27 at which half
// a unit of the force table, at the cutoff, is worth at most 1.7e-4 of the law's strongest pull and at most
// `half_unit` N, and at which kicks have no fewer fractional bits than velocities: laws with a steep core, as
// Lennard-Jones, need more than soft ones, small strains more than large ones. 27 is taken where none will
// do. The result says which.
//
// `table.index_bits` = 0 takes the least from 9 to 13 at which the table's force is within 2 half_unit of the
// law's, where bonds are: from 0.8 of the distance at rest to the cutoff. 13 is taken where none will do.
//
// Several laws share one shape and one unit: that of the largest f/r. The weakest law decides the widths
// above.
//
// Throws InputError, with numbers, where a format cannot hold the rule: cutoff beyond a cell edge, a negative
// shift, a velocity, gain, scale or mass out of its width.
FixedRule quantise(const Rule& rule, const CellEdges& edges, const Widths& widths, const TableChoice& table,
                   double half_unit = std::numeric_limits<double>::infinity());

// Its formats, types and motion alone: of a rule whose pair terms are a program. `cutoff2` is that of its
// reach.
FixedRule quantise_without_law(const Rule& rule, const CellEdges& edges, const Widths& widths);

// The rule with the masses that the fixed one gives its particles.
Rule with_masses_of(const FixedRule& fixed, Rule rule);

}  // namespace cuboct
