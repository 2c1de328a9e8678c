// SPDX-License-Identifier: MIT
// rtl_judge CASE --cache DIR [--changed DIR] [--mutants FILE] [--out FILE] [--jobs N] [--coverage]
// Judges the RTL by one case (judge.h). With --mutants, numbers one per line, each of them in a process of
// its own, after number 0, which must pass; a line `number<TAB>case<TAB>verdict<TAB>text` per mutant goes to
// --out. Exit status: 0, 1 where the RTL as it is does not pass, 2 where it cannot be judged.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>

#include "hw/program/command_line.h"
#include "hw/program/options.h"
#include "model/base/sanitized.h"
#include "tests/verify/judge.h"

namespace {

using namespace cuboct;
using namespace cuboct::test;

// A mutant's run that shows steps or particles without end is not stuck for the bench. It may take this many
// times the CPU time of the RTL, and a second; and this much memory.
constexpr double kPatience = 10;
constexpr rlim_t kMemory = rlim_t{2} << 30;

struct Request {
  std::string name, cache, mutants, out;
  NodeBuild build;
  int jobs = 1;
};

std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\t') c = ' ';
  return text.substr(0, 200);
}

void write_line(int file, int mutant, const std::string& name, const std::string& verdict,
                const std::string& text) {
  const std::string line = fmt::format("{}\t{}\t{}\t{}\n", mutant, name, verdict, one_line(text));
  if (::write(file, line.data(), line.size()) != static_cast<ssize_t>(line.size())) std::abort();
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void judge_one(const Judge& judge, const std::shared_ptr<const emu::Library>& library, int mutant,
               rlim_t seconds, int file) {
  const rlimit time{seconds, seconds + 1}, memory{kMemory, kMemory}, no_core{0, 0};
  setrlimit(RLIMIT_CPU, &time);
  if (!kSanitized) setrlimit(RLIMIT_AS, &memory);
  setrlimit(RLIMIT_CORE, &no_core);
  if (std::freopen("/dev/null", "w", stderr) == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr)
    std::abort();  // of Verilator's own words
  setenv("CUBOCT_MUTANT", std::to_string(mutant).c_str(), 1);
  try {
    const Judgement j = judge.judge(library);
    write_line(file, mutant, judge.of().name, to_string(j.verdict), j.text);
  } catch (const std::bad_alloc&) {
    write_line(file, mutant, judge.of().name, "stuck", "out of memory");
  }
  _exit(0);
}

int run(const Request& r) {
  Case c = case_of(r.name);
  c.name = r.name;
  std::vector<Judge::Run> runs = usual_runs(c.setup.plan);
  const Judge judge(std::move(c), std::move(runs));
  const auto library =
      std::make_shared<const emu::Library>(build_node(judge.of().setup.plan, r.build, r.cache));
  setenv("CUBOCT_MUTANT", "0", 1);
  const double begin = cpu_seconds();
  const Judgement as_is = judge.judge(library);
  const auto seconds = static_cast<rlim_t>(1 + kPatience * (cpu_seconds() - begin));
  fmt::print("{}: {}{}{}; {} runs: {} steps, {} particles, {} phases, {} cycles of nodes compared\n", r.name,
             to_string(as_is.verdict), as_is.text.empty() ? "" : ": ", as_is.text, judge.runs(), as_is.steps,
             as_is.particles, as_is.spans, as_is.cycles);
  if (judge.golden().fault) fmt::print("{}: golden stops: {}\n", r.name, judge.golden().fault->what());
  std::fflush(stdout);
  if (as_is.verdict != Verdict::passed) return 1;
  if (r.mutants.empty()) return 0;

  const int file = open(r.out.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  if (file < 0) throw InputError(fmt::format("cannot write {}", r.out));
  std::map<pid_t, int> running;
  const auto reap = [&] {
    int status = 0;
    const pid_t child = wait(&status);
    const int mutant = running.at(child);
    running.erase(child);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
    // The model ends the process where its logic does not settle; the limit of CPU time does where the run
    // goes on for ever.
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    write_line(file, mutant, r.name, signal == SIGXCPU || signal == SIGKILL ? "stuck" : "crash",
               fmt::format("signal {}", signal));
  };
  std::ifstream list(r.mutants);
  for (int mutant = 0; list >> mutant;) {
    while (static_cast<int>(running.size()) >= r.jobs) reap();
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("cannot fork");
    if (child == 0) judge_one(judge, library, mutant, seconds, file);
    running[child] = mutant;
  }
  while (!running.empty()) reap();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Request r;
  Command app("rtl_judge", "Judges the RTL of a node by one case");
  app.option("case", r.name, "Name of tests/support/cases.h, random_N, random_flat_N, fault_N").required();
  app.option("--cache", r.cache, "Where compiled nodes are kept").required();
  app.option("--changed", r.build.changed, "Modules in place of the library's");
  app.option("--optimise", r.build.optimise, "Of the C++ compiler").show_default();
  const Option out = app.option("--out", r.out, "Verdicts are added to this file");
  app.option("--mutants", r.mutants, "File of numbers").needs(out);
  app.option("--jobs,-j", r.jobs, "Mutants at a time").show_default();
  app.flag("--coverage", r.build.coverage, "Counts lines, into $CUBOCT_COVERAGE");
  if (const auto ended = parse_command_line(app, argc, argv)) return *ended;
  try {
    return run(r);
  } catch (const std::exception& e) {
    fmt::print(stderr, "rtl_judge: {}\n", e.what());
    return 2;
  }
}
