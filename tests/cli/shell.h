// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cuboct::test {

struct Answer {
  int code;  // exit code
  std::string out, err;
  double cpu = 0;       // s, of the program and all that it waited for
  int64_t peak_kb = 0;  // of its memory
};

// What a program may take; 0: no limit.
struct Limits {
  uint64_t memory = 0;       // bytes of address space
  uint64_t cpu_seconds = 0;  // ended by SIGXCPU beyond
  int cores = 0;             // bound to the first so many
};

// A directory of its own for each test, with a copy of cuboct and, if asked, fake engines beside it.
class Bench {
 public:
  explicit Bench(bool fake_engines);
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  // Runs cuboct in the root of the sources, without a terminal. `interrupt_after` > 0: sends SIGINT after so
  // many seconds.
  Answer cuboct(const std::vector<std::string>& arguments, double interrupt_after = 0,
                const Limits& limits = {}) const;
  std::string path(const std::string& name) const { return (directory_ / name).string(); }

 private:
  std::filesystem::path directory_;
};

// What cuboct says of a file, less the line that it shows of it (model/base/excerpt.h).
std::string without_excerpt(const std::string& text);

std::string contents(const std::string& path);

}  // namespace cuboct::test
