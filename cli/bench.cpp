// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>

#include "cli/command.h"
#include "cli/items.h"
#include "model/base/error.h"
#include "model/base/spelling.h"
#include "study/bench/bench_gpu.h"
#include "study/bench/bench_report.h"
#include "study/bench/benches.h"

namespace cuboct {
namespace {

struct Options {
  std::string name;
  bool list = false, json = false;
  int threads = 0;
  BenchLength length;
};

int bench(const Options& options) {
  const std::vector<Bench> list = benches(options.length, options.threads);
  if (options.list && options.json) {
    std::vector<Items> all(list.size());
    for (size_t k = 0; k < list.size(); ++k)
      all[k].add("name", list[k].name), all[k].add("what", list[k].what);
    Items items;
    items.add_list("benchmarks", "benchmark", all);
    fmt::print("{}", items.json());
    return 0;
  }
  if (options.list) {
    for (const Bench& entry : list) fmt::print("{:<32} {}\n", entry.name, entry.what);
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
  fmt::print("# {}\n", machine());
  if (std::any_of(chosen.begin(), chosen.end(), [](const Bench* entry) { return entry->gpu; }))
    if (const std::string why = gpu_left_out(); !why.empty()) {
      fmt::print("# gpu: {}{}\n", kSkipped, why);
      std::erase_if(chosen, [](const Bench* entry) { return entry->gpu; });
    }
  if (chosen.empty()) return 0;
  for (const Bench* entry : chosen)
    benchmark::RegisterBenchmark(entry->name.c_str(), entry->run)
        ->Iterations(1)
        ->Repetitions(entry->gpu    ? 1
                      : entry->once ? std::min(options.length.repeats, 3)
                                    : options.length.repeats)
        ->UseManualTime();
  int count = 1;
  char name[] = "cuboct";
  char* arguments[] = {name, nullptr};
  benchmark::Initialize(&count, arguments);
  LineReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return reporter.failed() ? 1 : 0;
}

}  // namespace

void add_bench(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("bench", "measure how fast the engines are");
  command->add_option("name", options->name, "a benchmark, or the first words of some; default: all")
      ->type_name("NAME");
  auto* list = command->add_flag("--list", options->list, "name the benchmarks");
  command->add_flag("--json", options->json, "print the list as JSON")->needs(list);
  command->add_option("--threads", options->threads, "threads of 'all cores'; default: every core")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  command->add_option("--repeats", options->length.repeats, "of which the median is told")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--seconds", options->length.seconds, "length of a repeat, but where steps are given")
      ->check(CLI::Range(1e-3, 1e4))
      ->capture_default_str()
      ->type_name("T");
  command->callback([options, &exit_code] { exit_code = bench(*options); });
}

}  // namespace cuboct
