// SPDX-License-Identifier: MIT
#include "model/base/host_compiler.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/text.h"

namespace cuboct {

namespace fs = std::filesystem;

std::string host_compiler() {
  const char* cxx = std::getenv("CXX");
  return cxx != nullptr && *cxx != 0 ? cxx : "c++";
}

std::string version_of(const std::string& tool, const std::string& package, const std::string& why) {
  constexpr int kNotFound = 127;  // of a shell
  std::string text;
  int status = -1;
  if (FILE* pipe = popen((tool + " --version 2>&1").c_str(), "r"); pipe != nullptr) {
    std::array<char, 256> part;
    while (std::fgets(part.data(), part.size(), pipe) != nullptr) text += part.data();
    status = pclose(pipe);
    if (status == 0) return text;
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotFound)
    throw InputError(fmt::format("{} is missing: {} (Debian package {})", tool, why, package));
  throw InputError(fmt::format("'{} --version' fails: the tool does not work", tool));
}

uint64_t key_of_texts(const std::vector<std::string>& texts) {
  Hash hash;
  for (const std::string& text : texts) {
    hash.add(static_cast<int64_t>(text.size()));
    for (const char c : text) hash.add(c);
  }
  return hash.value();
}

void run_logged(const std::string& what, const std::string& command, const fs::path& directory,
                const fs::path& log) {
  const std::string line = fmt::format("cd {} && ({}) >> {} 2>&1", shell_word(directory.string()), command,
                                       shell_word(log.string()));
  const int status = std::system(line.c_str());
  if (status == -1 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw InputError(fmt::format("{} failed: see {}", what, log.string()));
}

BuildDirectory::BuildDirectory(const fs::path& beginning) {
  std::string pattern = beginning.string() + "-XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr)
    throw InputError(fmt::format("cannot write in {}", beginning.parent_path().string()));
  path_ = pattern;
}

BuildDirectory::~BuildDirectory() {
  std::error_code error;
  fs::remove_all(path_, error);
}

}  // namespace cuboct
