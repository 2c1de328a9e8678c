// SPDX-License-Identifier: MIT
// The stages of `cuboct learn`: data, which are kept, then the kernel.
#pragma once

#include "study/learn/kernel_fit.h"

namespace cuboct::learn {

struct Tried {
  double horizon = 0;
  int degree = 0;
  KernelFit fit;
};
struct Learned {
  Grid grid;
  size_t atoms = 0;
  std::vector<StaticSample> training, validation;
  double strain = 0;             // the largest of a bond in all samples
  std::vector<Tried> tried;      // each horizon with each degree
  size_t best = 0;               // of those: the least validation residual among those whose constraints hold
  std::vector<KernelFit> drawn;  // the best again, samples drawn anew: its spread
};
// InputError where a sheet would be at rest under a load before it has moved. To be asked before all work.
void check_loads(const LearnStudy& study);
// DIR/samples.jsonl keeps the samples. Throws study::Interrupted, InputError where a horizon has too few
// points.
Learned learn(const LearnStudy& study, const std::string& directory, int jobs);

}  // namespace cuboct::learn
