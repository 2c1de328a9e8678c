// SPDX-License-Identifier: MIT
#include "tests/fuzz/targets.h"

#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <typeinfo>

#include "model/base/error.h"

namespace cuboct::fuzz {
namespace {

// Removed with what is in it when the process ends.
class Directory {
 public:
  Directory() : path_((std::filesystem::temp_directory_path() / "cuboct-fuzz-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no directory for temporary files");
  }
  ~Directory() {
    std::error_code none;
    std::filesystem::remove_all(path_, none);
  }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

void refusing(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    if (error.told().empty()) throw std::logic_error("a refusal without a text");
  } catch (const RunError&) {
  }
}

void failing(const std::function<void()>& work) {
  try {
    refusing(work);
  } catch (const std::runtime_error& error) {
    if (typeid(error) != typeid(std::runtime_error)) throw;
  }
}

std::string text_of(Bytes input) { return {input.begin(), input.end()}; }

std::string file_of(Bytes input, const std::string& name) {
  static const Directory directory;
  const std::string path = directory.path() + "/" + name;
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
  return path;
}

std::string in_tree(const std::string& path) { return std::string(CUBOCT_SOURCE_DIR "/") + path; }

}  // namespace cuboct::fuzz
