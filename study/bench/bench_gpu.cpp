// SPDX-License-Identifier: MIT
#include "study/bench/bench_gpu.h"

#include <fmt/format.h>

#include <fstream>
#include <map>
#include <sstream>

#include "model/base/process.h"
#include "study/bench/bench_report.h"

namespace cuboct {
namespace {

std::string program() { return beside("cuboct-gpu"); }

}  // namespace

std::string gpu_left_out() {
  if (program().empty()) return "no program cuboct-gpu beside cuboct";
  const Scratch scratch;
  const std::string path = scratch.path("machine");
  const int code = Process(program(), {"bench", "--machine", path}).wait();
  std::ifstream in(path);
  std::string line;
  if (code != 0 || !std::getline(in, line)) return fmt::format("cuboct-gpu ended with exit code {}", code);
  constexpr char kNone[] = "none: ";
  return line.starts_with(kNone) ? "no GPU: " + line.substr(sizeof kNone - 1) : "";
}

void run_gpu_row(benchmark::State& state, const std::string& row, int repeats, double seconds) {
  const Scratch scratch;
  const std::string path = scratch.path("lines");
  std::map<std::string, double> values;
  std::string comment;
  for (auto _ : state) {
    const int code = Process(program(), {"bench", "--only", row, "--repeats", std::to_string(repeats),
                                         "--seconds", fmt::format("{}", seconds), "--lines", path})
                         .wait();
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("# ")) {
        comment = line.substr(2);
        continue;
      }
      std::istringstream words(line);
      std::string name;
      double value = 0;
      if (words >> name >> value) values[name] = value;
    }
    if (values["repeat"] > 0 && values["particle_steps"] > 0) {
      state.SetIterationTime(values["repeat"]);
      continue;
    }
    // Its own reason, which begins with kSkipped where the row only does not fit.
    state.SkipWithError(comment.empty() ? fmt::format("cuboct-gpu ended with exit code {}", code).c_str()
                                        : comment.c_str());
    return;
  }
  state.counters["particle_steps"] =
      benchmark::Counter(values["particle_steps"] * values["repeat"], benchmark::Counter::kIsRate);
  state.SetLabel(comment);
}

}  // namespace cuboct
