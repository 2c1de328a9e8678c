// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cuboct::test {

struct Answer {
  int code;  // exit code
  std::string out, err;
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
  Answer cuboct(const std::vector<std::string>& arguments, double interrupt_after = 0) const;
  std::string path(const std::string& name) const { return (directory_ / name).string(); }

 private:
  std::filesystem::path directory_;
};

std::string contents(const std::string& path);

}  // namespace cuboct::test
