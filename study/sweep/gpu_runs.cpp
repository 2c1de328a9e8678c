// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/resources.h"
#include "model/base/text.h"
#include "study/sweep/gpu_program.h"
#include "study/sweep/interrupted.h"

namespace cuboct::study {
namespace {

// A pipe of which a program opens one end by name, as `Streams` has it.
class ProgramPipe {
 public:
  ProgramPipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0)
      throw InputError(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  ~ProgramPipe() { close_end(0), close_end(1); }
  ProgramPipe(const ProgramPipe&) = delete;
  ProgramPipe& operator=(const ProgramPipe&) = delete;

  int end(int which) const { return ends_[static_cast<size_t>(which)]; }  // 0: to read, 1: to write
  std::string name(int which) const { return fmt::format("/proc/self/fd/{}", end(which)); }
  void close_end(int which) {
    int& end = ends_[static_cast<size_t>(which)];
    if (end >= 0) close(std::exchange(end, -1));
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

// Whether all of it was written. A reader that has left is no signal.
bool write_all(int to, const std::string& text) {
  sigset_t pipe, before;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe, &before);
  size_t done = 0;
  while (done < text.size()) {
    const ssize_t some = write(to, text.data() + done, text.size() - done);
    if (some < 0 && errno == EINTR) continue;
    if (some < 0) break;
    done += static_cast<size_t>(some);
  }
  if (done < text.size() && sigismember(&before, SIGPIPE) == 0) {
    const timespec at_once{};
    sigtimedwait(&pipe, nullptr, &at_once);
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return done == text.size();
}

std::string line_of(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "[" : ", ") + toml_string(word);
  return line + "]\n";
}

}  // namespace

struct GpuRuns::Impl {
  explicit Impl(int at_once) {
    process.emplace(gpu_program(), std::vector<std::string>{"many", "--at-once", std::to_string(at_once)},
                    false, Streams{answers.name(1), scratch.path("errors"), asks.name(0)});
    asks.close_end(0), answers.close_end(1);
    reader = std::thread([this] { read_answers(); });
  }
  ~Impl() {
    asks.close_end(1);  // the end of its input
    reader.join();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void read_answers() {
    std::string text;
    for (bool passed_on = false;;) {
      if (interrupted() && !std::exchange(passed_on, true)) process->interrupt();
      pollfd from{answers.end(0), POLLIN, 0};
      constexpr int kLook = 100;  // ms: a signal meets any thread
      if (poll(&from, 1, kLook) <= 0) continue;
      std::array<char, 4096> some{};
      const ssize_t got = read(answers.end(0), some.data(), some.size());
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break;
      text.append(some.data(), static_cast<size_t>(got));
      for (size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
        take(text.substr(0, end));
        text.erase(0, end + 1);
      }
    }
    const int code = process->finish();
    const std::lock_guard lock(guard);
    ended = code < 0 ? fmt::format("cuboct-gpu was ended by signal {} ({})", -code, strsignal(-code))
                     : fmt::format("cuboct-gpu ended with exit code {}", code);
    changed.notify_all();
  }
  // "NUMBER CODE"; other lines are none of its.
  void take(const std::string& line) {
    char* rest = nullptr;
    const uint64_t number = std::strtoull(line.c_str(), &rest, 10);
    if (number == 0 || *rest != ' ') return;
    const std::lock_guard lock(guard);
    codes[number] = std::atoi(rest);
    changed.notify_all();
  }
  std::string trouble() const {
    std::string said = read_text(scratch.path("errors"));
    while (said.ends_with('\n')) said.pop_back();
    return said.empty() ? *ended : said;
  }

  Scratch scratch;
  ProgramPipe asks, answers;
  std::optional<Process> process;
  std::mutex guard;  // of what follows
  std::condition_variable changed;
  uint64_t asked = 0;
  std::map<uint64_t, int> codes;
  std::optional<std::string> ended;
  std::thread reader;
};

GpuRuns::GpuRuns(int at_once) : impl_(std::make_unique<Impl>(at_once)) {}
GpuRuns::~GpuRuns() = default;

int GpuRuns::run(const std::vector<std::string>& words) {
  Impl& all = *impl_;
  std::unique_lock lock(all.guard);
  const uint64_t number = ++all.asked;
  if (!all.ended && !write_all(all.asks.end(1), line_of(words)))
    all.changed.wait(lock, [&] { return all.ended.has_value(); });
  all.changed.wait(lock, [&] { return all.codes.contains(number) || all.ended; });
  if (const auto found = all.codes.find(number); found != all.codes.end()) {
    const int code = found->second;
    all.codes.erase(found);
    return code;
  }
  if (interrupted()) throw Interrupted();
  throw std::runtime_error(all.trouble());
}

int gpu_runs_at_once() {
  constexpr int kMost = 64;
  return std::min(4 * usable_cores(), kMost);
}

}  // namespace cuboct::study
