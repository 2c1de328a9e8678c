// SPDX-License-Identifier: MIT
// `cuboct multiscale --gpu`: another program computes, and its results come by the study's file of progress.
#pragma once

#include <string>

#include "model/atoms/multiscale/element_study.h"

namespace cuboct {

// InputError where no GPU can have the study's samples, or this build has no program for one.
void check_gpu(const ElementStudy& study);

struct GpuElements {
  std::string study, progress;  // files
  std::string before;           // on the terminal, before the line of progress
  size_t point = 0;             // of [compare], from 1; 0: the study itself
  int threads = 0;              // of the host; 0: one per core
};

// Brings the file of progress to its end, from wherever it is: it is the same of every engine. InputError
// where there is no device; Failed where a body fails or the run was interrupted.
void run_on_gpu(const GpuElements& run);

}  // namespace cuboct
