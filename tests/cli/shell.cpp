// SPDX-License-Identifier: MIT
#include "tests/cli/shell.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "model/base/sanitized.h"

namespace cuboct::test {

namespace fs = std::filesystem;

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

size_t count(const std::string& text, const std::string& part) {
  size_t found = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

std::string without_excerpt(const std::string& text) {
  return std::regex_replace(text, std::regex("\n *[0-9]+ \\| [^\n]*\n +\\| +\\^(?=\n)"), "");
}

Bench::Bench(bool fake_engines) {
  std::string name = (fs::temp_directory_path() / "cuboct-test-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("mkdtemp");
  directory_ = name;
  fs::create_directory(directory_ / "bin");
  const fs::path built = fs::path(CUBOCT_PROGRAM).parent_path();
  fs::copy(CUBOCT_PROGRAM, directory_ / "bin/cuboct");
  // A program looks beside itself, through symbolic links.
  for (const char* program : {"cuboct-study", "cuboct-machine", "cuboct-bench", "cuboct-view"}) {
    if (!fs::exists(built / program)) continue;  // a part that is left out
    std::error_code other_disk;
    fs::create_hard_link(built / program, directory_ / "bin" / program, other_disk);
    if (other_disk) fs::copy(built / program, directory_ / "bin" / program);
  }
  const fs::path evolution = built / "cuboct-evolution.so";
  fs::create_symlink(built / "cuboct-read-trace", directory_ / "bin/cuboct-read-trace");
  if (fs::exists(evolution)) fs::create_symlink(evolution, directory_ / "bin/cuboct-evolution.so");
  if (fake_engines)
    for (const char* engine : {"cuboct-systemc", "cuboct-rtl"})
      fs::copy(FAKE_ENGINE, directory_ / "bin" / engine);
}

Bench::~Bench() {
  std::error_code none;
  fs::remove_all(directory_, none);
}

namespace {

void obey(const Limits& limits) {
  const auto limit = [](int resource, uint64_t most) {
    const rlimit both{most, most};
    if (most > 0) setrlimit(static_cast<__rlimit_resource>(resource), &both);
  };
  if (!kSanitized) limit(RLIMIT_AS, limits.memory);
  limit(RLIMIT_CPU, limits.cpu_seconds);
  if (limits.cores == 0) return;
  cpu_set_t have, set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof have, &have);
  for (int c = 0, left = limits.cores; c < CPU_SETSIZE && left > 0; ++c)
    if (CPU_ISSET(c, &have)) CPU_SET(c, &set), --left;
  sched_setaffinity(0, sizeof set, &set);
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

Condition there(const std::string& path) {
  return [path](pid_t) { return fs::exists(path); };
}

bool catches_interrupts(pid_t program) {
  std::ifstream status("/proc/" + std::to_string(program) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("SigCgt:"))
      return (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1) != 0;
  return false;
}

bool comes(const std::function<bool()>& what) {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::minutes(10); Clock::now() < end;
       std::this_thread::sleep_for(std::chrono::milliseconds(1)))
    if (what()) return true;
  return false;
}

Condition Bench::table_begins() const {
  // Names, units, and the row of the first step.
  return [file = path("err")](pid_t) {
    const std::string text = contents(file);
    return std::count(text.begin(), text.end(), '\n') >= 3;
  };
}

Answer Bench::cuboct(const std::vector<std::string>& arguments, const Condition& interrupts,
                     const Limits& limits) const {
  // What an earlier one said is nothing to wait for.
  for (const char* name : {"out", "err"}) fs::remove(path(name));
  const std::string program = path("bin/cuboct");
  std::vector<char*> argv{const_cast<char*>("cuboct")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    const auto redirect = [](int to, const std::string& file, int flags) {
      const int from = open(file.c_str(), flags, 0666);
      dup2(from, to);
    };
    redirect(0, "/dev/null", O_RDONLY);
    redirect(1, path("out"), O_WRONLY | O_CREAT | O_TRUNC);
    redirect(2, path("err"), O_WRONLY | O_CREAT | O_TRUNC);
    obey(limits);
    if (chdir(CUBOCT_SOURCE_DIR) == 0) execv(program.c_str(), argv.data());
    _exit(127);
  }
  siginfo_t ended{};
  while (interrupts && waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         ended.si_pid == 0) {
    if (interrupts(child)) {
      kill(child, SIGINT);
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), contents(path("out")),
          contents(path("err")), seconds(used.ru_utime) + seconds(used.ru_stime), used.ru_maxrss};
}

}  // namespace cuboct::test
