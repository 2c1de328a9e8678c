// SPDX-License-Identifier: MIT
// Code that this program makes, compiled on the machine that runs it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cuboct {

// Words of a shell: as make and CMake have it, CXX may hold words before the compiler ("ccache g++") and
// behind it; c++ without it.
std::string host_compiler();

// What a tool (words of a shell) says of itself. Throws InputError where it does not work; where it is
// missing the error names `package`, and `why` it is needed.
std::string version_of(const std::string& tool, const std::string& package, const std::string& why);

// Of texts in their order: names what is made of them alone.
uint64_t key_of_texts(const std::vector<std::string>& texts);

// Runs `command`, a line of a shell, in `directory`; what it says is appended to `log`. Throws InputError
// ("WHAT failed: see LOG").
void run_logged(const std::string& what, const std::string& command, const std::filesystem::path& directory,
                const std::filesystem::path& log);

// A new directory beside those of the same beginning, removed with its owner. What is built in it can be
// renamed to its neighbour. Throws InputError.
class BuildDirectory {
 public:
  explicit BuildDirectory(const std::filesystem::path& beginning);
  ~BuildDirectory();
  BuildDirectory(const BuildDirectory&) = delete;
  BuildDirectory& operator=(const BuildDirectory&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace cuboct
