// SPDX-License-Identifier: MIT
#include "study/bench/bench_report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "model/base/resources.h"

namespace cuboct {

std::string machine() {
  std::string model = "processor unknown";
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  const double memory =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e9;
  return fmt::format("{}, {} cores, {:.0f} GB of memory", model, usable_cores(), memory);
}

bool LineReporter::ReportContext(const Context&) { return true; }

void LineReporter::note(const std::string& text) {
  notes_.push_back(text);
  if (!silent_) fmt::print("# {}\n", text);
}

void LineReporter::ReportRuns(const std::vector<Run>& runs) {
  const auto name_of = [](const Run& run) { return run.run_name.function_name; };
  const Run* spread = nullptr;
  for (const Run& run : runs)
    if (run.aggregate_name == "stddev") spread = &run;
  for (const Run& run : runs) {
    if (run.error_occurred) {
      if (skipped_ != name_of(run)) note(fmt::format("{}: {}", name_of(run), run.error_message));
      skipped_ = name_of(run);  // its repetitions say the same
      failed_ |= !run.error_message.starts_with(kSkipped);
      continue;
    }
    const bool alone = run.run_type == Run::RT_Iteration && run.repetitions == 1;
    if (!alone && run.aggregate_name != "median") continue;
    if (!run.report_label.empty()) note(fmt::format("{}: {}", name_of(run), run.report_label));
    for (const auto& [counter, value] : run.counters) {
      if (spread && value.value > 0)
        note(fmt::format("{}: {} repeats of {:.4g} s, standard deviation {:.1f} %", name_of(run),
                         run.repetitions,
                         run.GetAdjustedRealTime() / benchmark::GetTimeUnitMultiplier(run.time_unit),
                         100 * spread->counters.at(counter).value / value.value));
      rows_.push_back({name_of(run) + "." + counter, value.value});
      if (!silent_) fmt::print("{} {:.4g} 1/s\n", rows_.back().name, value.value);
    }
  }
  std::fflush(stdout);
}

}  // namespace cuboct
