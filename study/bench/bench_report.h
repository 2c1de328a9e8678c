// SPDX-License-Identifier: MIT
// What `cuboct bench` prints of what it measured.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace cuboct {

// "name value unit" lines, one per rate: the median over the repetitions, whose length (the median too) and
// spread stand in a comment line before. Comment lines begin with "# ".
class LineReporter : public benchmark::BenchmarkReporter {
 public:
  // `silent`: prints nothing.
  explicit LineReporter(bool silent) : silent_(silent) {}
  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;
  // Some benchmark failed, other than for want of memory or of a program.
  bool failed() const { return failed_; }
  // What was measured, 1/s, and what was said of it.
  struct Row {
    std::string name;
    double value;
  };
  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  void note(const std::string& text);

  bool silent_, failed_ = false;
  std::vector<Row> rows_;
  std::vector<std::string> notes_;
  std::string skipped_;
};

// "AMD EPYC 9B14, 4 cores, 24 GB of memory".
std::string machine();

// What a benchmark says where it does not run, and why: no failure.
inline constexpr char kSkipped[] = "skipped: ";

}  // namespace cuboct
