// SPDX-License-Identifier: MIT
// What a run shows of itself on stderr while it goes: a line in place where stderr is a terminal, and a table
// with a row every so often. Values are those that were read for the curves: nothing is read for a row.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/base/progress.h"
#include "model/scene/scene.h"
#include "model/trace/trace.h"

namespace cuboct {

enum class LogRows : uint8_t {
  off,      // the line in place alone
  quiet,    // not even that
  seconds,  // a row each two seconds and each tenth of the run: for who looks on
  parts,    // twenty rows per run: for a file
};

constexpr bool has_rows(LogRows rows) { return rows == LogRows::seconds || rows == LogRows::parts; }

// "off", "quiet", "seconds", "parts"
const char* to_string(LogRows rows);

class RunLog {
 public:
  struct Run {
    std::string engine;
    uint64_t steps = 0, particles = 0;
    std::vector<uint64_t> samples;  // steps at which curves are read, ascending
    LogRows rows = LogRows::off;
  };
  // `curves`: names and units, of Meter::curves.
  RunLog(Run run, const Scene& scene, const std::vector<Curve>& curves);

  // A run begins at `step`, or goes on from there.
  void begin(uint64_t step);
  // Where a batch is to end, so that a row can follow: above `step`.
  uint64_t next_row(uint64_t step) const;
  // After each batch. `sampled`: curves are read after this step. `latest`: the last value of each, called
  // only for a row of a step that was sampled.
  using Latest = std::function<std::vector<double>()>;
  void at(uint64_t step, bool sampled, const Latest& latest);
  // The last row of a run, whenever it ended.
  void end(uint64_t step, bool sampled, const Latest& latest);

 private:
  using Clock = std::chrono::steady_clock;
  struct Column {
    std::string name, unit;
    size_t curve, width;
  };
  bool is_due(uint64_t step, bool sampled) const;
  bool waits(uint64_t step, Clock::time_point now) const;
  void head();
  void row(uint64_t step, bool sampled, const Latest& latest);

  Run run_;
  double dt_;      // s
  uint64_t load_;  // time steps that make a load step of static loading; 0: motion
  std::vector<Column> columns_;
  std::vector<uint64_t> rows_;  // of LogRows::parts, ascending
  size_t dropped_ = 0;          // columns beyond the terminal's width
  Progress progress_;
  uint64_t first_ = 0, shown_ = 0;  // steps: of the begin, of the last row
  bool any_ = false;                // rows so far
  Clock::time_point begin_, last_;  // last_: of the last row
};

}  // namespace cuboct
