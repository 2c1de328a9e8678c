// SPDX-License-Identifier: MIT
// A node for each macro-element: what relaxing the element's sample takes on a machine like that of
// docs/reference/node.md, in operations, cycles and joules. The node computes model/atoms/bond_order/
// tersoff_datapath.h in fixed point of one width; its operations are counted while it does.
// docs/reference/sample_node.md has the terms.
#pragma once

#include <array>

#include "hw/cost/energy.h"
#include "model/atoms/bond_order/tersoff_datapath.h"
#include "model/atoms/multiscale/sample_material.h"
#include "study/sample_node/datapath_number.h"

namespace cuboct {

struct SampleNodeOptions {
  int fraction = 22;           // bits behind the point, of all numbers, in eV and angstrom
  uint64_t table_words = 256;  // that a table has at most
  double strain = 1e-3;        // of the sample that is relaxed
};

struct SampleNode {
  uint64_t atoms = 0, bonds = 0, pairs = 0;  // of a sample; ordered bonds, pairs of bonds of an atom
  int fraction = 0, width = 0;               // bits; with sign and what stands before the point
  uint64_t bond_words = 0, angle_words = 0, stretch_words = 0, order_words = 0;  // of the tables; 0: none
  uint32_t evaluations = 0;                                                      // of the relaxation
  std::array<OperationCounts, kDatapathStages> stages;                           // of one evaluation
  OperationCounts relaxation;                                                    // of all of it
  int depth = 0;            // operations in a row, of an atom
  double force_error = 0;   // largest difference of a component over the largest component, atoms shaken
  double stress_error = 0;  // the same of the stress at rest, beside doubles

  double atom_steps() const { return static_cast<double>(atoms) * evaluations; }
  OperationCounts evaluation() const;  // sum of the stages
  // A bond and a pair enter each of their stages in a cycle; atoms follow one another; then a sweep moves
  // them, and one division makes the step's length, a bit a cycle.
  double cycles_of_evaluation() const;
  double cycles() const { return evaluations * cycles_of_evaluation(); }  // of the relaxation
};

// Relaxes a strained sample in the node's numbers. InputError where the sample leaves the tables or does not
// come to rest in them.
SampleNode count_sample_node(const SampleMaterial& material, const TersoffTerm<double>& term,
                             const SampleNodeOptions& options = {});

// Of the relaxation, as hw/cost/energy.h has it for a plan.
Energy energy_of(const SampleNode& node, double clock, const Technology& technology);
// mm^2 of the node; low and high are 0 where a figure is missing.
Band area_of(const SampleNode& node, const Technology& technology);

}  // namespace cuboct
