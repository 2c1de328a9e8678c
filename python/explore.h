// SPDX-License-Identifier: MIT
// A study's points as the columns of a table.
#pragma once

#include <string>
#include <vector>

namespace cuboct::python {

struct Column {
  std::string name;
  std::vector<double> numbers;     // one per point; nan: not measured
  std::vector<std::string> texts;  // or these
};

struct Table {
  std::vector<Column> columns;
  std::string left_out;  // what cannot run here, and why; empty: nothing
};

struct ExploreAsked {
  std::string study, out;  // file and directory
  int jobs = 0;            // 0: one per core
  bool speed = true;
};

// Computes what the directory lacks, and keeps it there. Throws Interrupted (python/sources.h). InputError
// where this build has no studies.
Table explore(const ExploreAsked& asked);

}  // namespace cuboct::python
