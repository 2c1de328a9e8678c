// SPDX-License-Identifier: MIT
#include "hw/pipeline/sum_bits.h"

#include <algorithm>

namespace cuboct::pipeline {
namespace {

size_t place(int k) { return static_cast<size_t>(k); }

}  // namespace

int kick_bits(const graph::Round& round, const Schedule& schedule, int sum) {
  int bits = 1;
  const int first = round.place(sum);
  for (size_t c = 0; c < round.sums[place(sum)].terms.size(); ++c) {
    const Step& step = schedule.steps.steps[place(schedule.steps.outputs[place(first) + c].step)];
    bits = std::max(bits, signed_bits({step.bits, step.is_signed}));
  }
  return bits;
}

int sum_bits(const graph::FixedProgram& program, const graph::Round& round, const Schedule& schedule,
             int sum) {
  int bits = kick_bits(round, schedule, sum);
  for (const int term : round.sums[place(sum)].terms)
    bits = std::max(
        bits, signed_bits(form_of(graph::summed(round.pair.nodes[place(term)].range, program.partners))));
  return bits;
}

}  // namespace cuboct::pipeline
