// SPDX-License-Identifier: MIT
// `cuboct-bench`.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/front.h"
#include "cli/programs.h"
#include "hw/program/bounds.h"
#include "hw/program/options.h"
#include "model/base/error.h"
#include "model/base/json.h"
#include "model/base/spelling.h"
#include "model/base/standard_streams.h"
#include "study/bench/bench_gpu.h"
#include "study/bench/bench_report.h"
#include "study/bench/benches.h"

namespace cuboct {
namespace {

struct Options {
  std::string name;
  bool list = false;
  Answer answer;
  int threads = 0;
  BenchLength length;
  bool anyway = false;
};

// Nobody waits for a row that nobody reads.
std::function<void(benchmark::State&)> unless_lost(std::function<void(benchmark::State&)> run) {
  return [run = std::move(run)](benchmark::State& state) {
    if (output_is_lost())
      state.SkipWithError(fmt::format("{}nobody reads", kSkipped).c_str());
    else
      run(state);
  };
}

int bench(const Options& options) {
  check_workers("--threads", options.threads, options.anyway);
  const std::vector<Bench> list = benches(options.length, options.threads);
  const Answer& answer = options.answer;
  if (options.list) {
    std::vector<Items> all(list.size());
    for (size_t k = 0; k < list.size(); ++k) {
      answer.say("{:<32} {}\n", list[k].name, list[k].what);
      all[k].add("name", list[k].name), all[k].add("what", list[k].what);
    }
    Items items;
    items.add_list("benchmarks", "benchmark", all);
    if (answer.json) answer.close(items);
    return 0;
  }
  std::vector<const Bench*> chosen;
  std::vector<std::string> names;
  for (const Bench& entry : list) {
    names.push_back(entry.name);
    if (options.name.empty() || entry.name == options.name || entry.name.starts_with(options.name + "."))
      chosen.push_back(&entry);
  }
  if (chosen.empty()) {
    const std::string near = did_you_mean(options.name, names);
    throw InputError(fmt::format("no benchmark '{}'", options.name),
                     near.empty() ? "'cuboct bench --list' names them" : near);
  }
  check_time(fmt::format("{} benchmark{} with --repeats {} --seconds {:g}", chosen.size(),
                         chosen.size() == 1 ? "" : "s", options.length.repeats, options.length.seconds),
             static_cast<double>(chosen.size()) * options.length.repeats * options.length.seconds,
             "fewer repeats", options.anyway);
  answer.say("# {}\n", machine());
  std::vector<std::string> notes;
  if (std::any_of(chosen.begin(), chosen.end(), [](const Bench* entry) { return entry->gpu; }))
    if (const std::string why = gpu_left_out(); !why.empty()) {
      notes.push_back(fmt::format("gpu: {}{}", kSkipped, why));
      answer.say("# {}\n", notes.back());
      std::erase_if(chosen, [](const Bench* entry) { return entry->gpu; });
    }
  LineReporter reporter(answer.json);
  const auto end = [&](int code) {
    notes.insert(notes.end(), reporter.notes().begin(), reporter.notes().end());
    const auto row = [](const LineReporter::Row& row) {
      return json_object(
          {{"name", json(row.name)}, {"value", json(row.value)}, {"unit", json(std::string("1/s"))}});
    };
    answer.close(json_object({{"machine", json(machine())},
                              {"results", json_array(reporter.rows(), row)},
                              {"notes", json(notes)}}));
    return code;
  };
  if (chosen.empty()) return end(0);
  for (const Bench* entry : chosen)
    benchmark::RegisterBenchmark(entry->name.c_str(), unless_lost(entry->run))
        ->Iterations(1)
        ->Repetitions(entry->gpu    ? 1
                      : entry->once ? std::min(options.length.repeats, 3)
                                    : options.length.repeats)
        ->UseManualTime();
  int count = 1;
  char name[] = "cuboct";
  char* arguments[] = {name, nullptr};
  benchmark::Initialize(&count, arguments);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return end(reporter.failed() ? 1 : 0);
}

}  // namespace

void add_bench(Command& app, int& exit_code) {
  auto [command, options] = add_command<Options>(app, "bench", exit_code, bench);
  command.option("name", options->name, "a benchmark, or the first words of some; default: all", "NAME");
  command.flag("--list", options->list, "name the benchmarks");
  options->answer.add_to(command);
  command.option("--threads", options->threads, "threads of 'all cores'; default: every core", "N")
      .range(1, 4096);
  command.option("--repeats", options->length.repeats, "of which the median is told", "N")
      .range(1, 1000)
      .show_default();
  command.option("--seconds", options->length.seconds, "length of a repeat, but where steps are given", "T")
      .range(1e-3, 1e4)
      .show_default();
  add_anyway_to(command, options->anyway);
}

}  // namespace cuboct

int main(int argc, char** argv) {
  using namespace cuboct;
  constexpr OwnCommand kOwn[] = {{"bench", add_bench}};
  return front(argc, argv, kOwn);
}
