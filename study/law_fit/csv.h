// SPDX-License-Identifier: MIT
// Columns of numbers with a line of names and units above them.
#pragma once

#include <string>
#include <vector>

namespace cuboct::fit {

struct CsvColumn {
  std::string name,
      unit;        // "stress", "MPa" of "stress (MPa)", "stress [MPa]" or "stress/MPa"; unit may be empty
  int column = 1;  // in the header, from 1
  std::vector<double> values;
};
struct Csv {
  std::string path, text;
  int header = 1;          // line
  std::vector<int> lines;  // of each row
  std::vector<CsvColumn> columns;

  // Points at the header, or at a row's line.
  [[noreturn]] void fail(int line, int column, const std::string& message,
                         const std::string& hint = {}) const;
};

// Fields parted by commas, semicolons or tabs; lines that are empty or begin with '#' are passed over.
// InputError with the place for a row of another length, and for what is no finite number.
Csv read_csv(const std::string& path);

}  // namespace cuboct::fit
