// SPDX-License-Identifier: MIT
#include "emu/gpu/many.h"

#include <fmt/format.h>
#include <poll.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "emu/gpu/device/sharing.h"
#include "emu/gpu/engine.h"
#include "emu/gpu/program.h"
#include "hw/program/command_line.h"
#include "hw/program/options.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/resources.h"

namespace cuboct::gpu {
namespace {

struct AskedRun {
  uint64_t number;
  std::vector<std::string> words;
};

std::vector<std::string> words_of(const std::string& line, uint64_t number) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("line {} of standard input: {}", number, why),
                     R"(a run is its words: ["scene.toml", "--out", "trace.h5"])");
  };
  std::vector<std::string> words;
  try {
    const toml::table table = toml::parse("words = " + line);
    const toml::array* array = table["words"].as_array();
    if (!array || table.size() != 1) refuse("no array of words");
    for (const toml::node& node : *array) {
      const auto* word = node.as_string();
      if (!word) refuse("a word is a string");
      words.push_back(word->get());
    }
  } catch (const toml::parse_error& error) {
    refuse(std::string(error.description()));
  }
  return words;
}

// Standard input, a line at a time; nothing once it has ended, or an interrupt has come.
class Lines {
 public:
  std::optional<std::string> next() {
    for (;;) {
      if (const size_t end = text_.find('\n'); end != std::string::npos) return taken(end, end + 1);
      if (ended_) return text_.empty() ? std::nullopt : std::optional(taken(text_.size(), text_.size()));
      if (interrupted()) return std::nullopt;
      pollfd input{STDIN_FILENO, POLLIN, 0};
      constexpr int kLook = 100;  // ms: a signal may meet another thread
      if (poll(&input, 1, kLook) <= 0) continue;
      std::array<char, 4096> some{};
      const ssize_t got = read(STDIN_FILENO, some.data(), some.size());
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) ended_ = true;
      if (got > 0) text_.append(some.data(), static_cast<size_t>(got));
    }
  }

 private:
  std::string taken(size_t end, size_t rest) {
    std::string line = text_.substr(0, end);
    text_.erase(0, rest);
    return line;
  }
  std::string text_;
  bool ended_ = false;
};

class Runs {
 public:
  explicit Runs(int at_once) {
    for (int k = 0; k < at_once; ++k) threads_.emplace_back([this] { work(); });
  }
  Runs(const Runs&) = delete;
  Runs& operator=(const Runs&) = delete;
  ~Runs() {
    {
      const std::lock_guard lock(guard_);
      closed_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  void ask(AskedRun asked) {
    const std::lock_guard lock(guard_);
    queue_.push_back(std::move(asked));
    changed_.notify_one();
  }

 private:
  void work() {
    for (;;) {
      std::unique_lock lock(guard_);
      changed_.wait(lock, [this] { return closed_ || !queue_.empty(); });
      if (queue_.empty()) return;
      const AskedRun asked = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      const int code = interrupted() ? 1 : run(asked.words);
      lock.lock();
      fmt::print("{} {}\n", asked.number, code);
      std::fflush(stdout);
    }
  }
  static int run(const std::vector<std::string>& words) {
    std::vector<std::string> all{"cuboct-gpu"};
    all.insert(all.end(), words.begin(), words.end());
    std::vector<char*> argv;
    for (std::string& word : all) argv.push_back(word.data());
    argv.push_back(nullptr);
    const Sharing::Run here;
    return run_among_many(static_cast<int>(all.size()), argv.data());
  }

  std::mutex guard_;
  std::condition_variable changed_;
  std::deque<AskedRun> queue_;
  bool closed_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace

int run_many(int argc, char** argv) {
  // A run prepares its scene while others step; more than 64 step no faster (docs/measured/study.md).
  constexpr int kMost = 64;
  int at_once = std::min(4 * usable_cores(), kMost);
  Command app("cuboct-gpu many",
              "Runs scenes at once on a device: each line of standard input is a run, an array of its words; "
              "a line of standard output tells the number of one that has ended, and its exit code");
  app.option("--at-once", at_once, "Runs that go on at once").range(1, 256).show_default();
  return run_command_line(app, argc, argv, [&] {
    catch_interrupts();
    share_devices(at_once > usable_cores());
    std::string why;
    if (find_devices(&why).empty()) throw InputError("the gpu engine needs a CUDA device: " + why);
    Lines lines;
    Runs runs(at_once);
    uint64_t number = 0;
    while (const auto line = lines.next()) runs.ask({++number, words_of(*line, number)});
    return interrupted() ? 1 : 0;
  });
}

}  // namespace cuboct::gpu
