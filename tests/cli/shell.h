// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
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

// Of a program that runs: asked until it is true.
using Condition = std::function<bool(pid_t program)>;
Condition there(const std::string& path);  // a file
bool catches_interrupts(pid_t program);    // SIGINT has a handler

// Waits until `what` is true; false after ten minutes, which no busy machine needs.
bool comes(const std::function<bool()>& what);

// A directory of its own for each test, with cuboct, the programs of its other commands and, if asked, fake
// engines beside it.
class Bench {
 public:
  explicit Bench(bool fake_engines);
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  // Runs cuboct in the root of the sources, without a terminal. SIGINT comes once `interrupts` is true: tests
  // wait for what they see, not for a time.
  Answer cuboct(const std::vector<std::string>& arguments, const Condition& interrupts = {},
                const Limits& limits = {}) const;
  // The table of a run on stderr has a row.
  Condition table_begins() const;
  std::string path(const std::string& name) const { return (directory_ / name).string(); }

 private:
  std::filesystem::path directory_;
};

// What cuboct says of a file, less the line that it shows of it (model/base/excerpt.h).
std::string without_excerpt(const std::string& text);

std::string contents(const std::string& path);
// How often the part stands in the text.
size_t count(const std::string& text, const std::string& part);

}  // namespace cuboct::test
