// SPDX-License-Identifier: MIT
#include "cli/run/text_cost.h"

namespace cuboct {
namespace {

// s, of a node and one lane. Fitted to heat, glass, copper, langevin and dpd of scenes/rules in the reference
// engine, on one thread: 31, 100, 86, 64 and 375 ns of a particle and a neighbour; within a sixth of each.
double time_of(const RealNode& node) {
  constexpr double kArithmetic = 0.4e-9, kRoot = 1.2e-9, kFunction = 12e-9, kTable = 2e-9, kGather = 1.2e-9,
                   kNoise = 300e-9;
  switch (node.op) {
    case RealOp::constant:
      return 0;
    case RealOp::input:
      return node.input.source == RealSource::noise ? kNoise : kGather;
    case RealOp::divide:
    case RealOp::square_root:
      return kRoot;
    case RealOp::exponential:
    case RealOp::logarithm:
    case RealOp::sine:
    case RealOp::cosine:
    case RealOp::error_function:
    case RealOp::power:
      return kFunction;
    case RealOp::curve:
    case RealOp::curve_slope:
      return kTable;
    default:
      return kArithmetic;
  }
}

double time_of(const RealGraph& graph) {
  double sum = 0;
  for (const RealNode& node : graph.nodes()) sum += time_of(node);
  return sum;
}

}  // namespace

TextCost text_cost(const RuleProgram& program) {
  // Each round gathers its neighbours: bonds of the packing, or those of a list that are near enough.
  const double found = program.declaration.bonds == BondRange::current ? 32e-9 : 22e-9;
  TextCost cost;
  for (const ProgramRound& round : program.rounds) {
    cost.neighbour += found + time_of(round.pair);
    cost.particle += time_of(round.finish);
  }
  return cost;
}

}  // namespace cuboct
