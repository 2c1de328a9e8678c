// SPDX-License-Identifier: MIT
// `cuboct explore STUDY` of a study of machines.
#pragma once

#include <string>

#include "cli/answer.h"

namespace cuboct {

struct ExploreMachines {
  std::string study;  // the file
  std::string out;  // DIR: machines.tsv, machines.jsonl, page and charts; results.db where there are figures
  int jobs = 0;     // 0: one per core
  bool best = false;     // choose one
  bool confirm = false;  // synthesise the one that is chosen, also where an estimate decides
  std::string emit;      // directory for its project; empty: none
};

// The exit code: 0, or 1 where a choice is asked for and no machine keeps the constraints.
int explore_machines(const ExploreMachines& options, const Answer& answer);

}  // namespace cuboct
