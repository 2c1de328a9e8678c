// SPDX-License-Identifier: MIT
#include "model/base/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "model/base/error.h"
#include "model/base/resources.h"
#include "model/base/spelling.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why, const std::string& hint = {}) {
  throw InputError(
      fmt::format("{}: cannot read this file{}{}", line_text(path), why.empty() ? "" : ": ", why), hint);
}

std::string kind_of(mode_t mode) {
  return S_ISDIR(mode) ? "it is a directory" : S_ISFIFO(mode) ? "it is a pipe" : "it is a device";
}

// Of a file that is not there: the name beside it that is nearest in spelling.
std::string nearest_beside(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path directory = fs::path(path).parent_path();
  std::vector<std::string> names;
  std::error_code none;
  for (fs::directory_iterator at(directory.empty() ? "." : directory, none), end; at != end;
       at.increment(none))
    if (at->is_regular_file(none)) names.push_back(at->path().filename().string());
  std::ranges::sort(names);
  const std::string near = nearest_spelling(fs::path(path).filename().string(), names);
  return near.empty() ? "" : fmt::format("did you mean '{}'?", (directory / near).string());
}

struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) close(number);
  }
};

}  // namespace

bool is_file(const std::string& path) {
  std::error_code none;
  return std::filesystem::is_regular_file(path, none);
}

std::string read_input(const std::string& path, uint64_t most) {
  // Without waiting for a pipe's writer; what a writer is to write is waited for.
  const Descriptor file{open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
  struct stat status {};
  if (file.number < 0 && errno == ENOENT) refuse(path, "", nearest_beside(path));
  if (file.number < 0 || fstat(file.number, &status) != 0) refuse(path, "");
  if (!S_ISREG(status.st_mode) && !S_ISFIFO(status.st_mode)) refuse(path, kind_of(status.st_mode));
  fcntl(file.number, F_SETFL, 0);
  const auto too_much = [&](const std::string& bytes) {
    refuse(path,
           fmt::format("it holds {}, and at most {} are read", bytes, in_bytes(static_cast<double>(most))));
  };
  const auto size = static_cast<uint64_t>(status.st_size);
  if (size > most) too_much(in_bytes(static_cast<double>(size)));
  std::string text;
  for (size_t bytes = 0;; bytes = text.size()) {
    text.resize(bytes + std::max<size_t>(size - std::min<size_t>(size, bytes), 1 << 16));
    const ssize_t got = read(file.number, text.data() + bytes, text.size() - bytes);
    text.resize(bytes + static_cast<size_t>(std::max<ssize_t>(got, 0)));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(path, "");
    if (got == 0) return text;
    if (text.size() > most) too_much("more");
  }
}

void check_is_file(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) refuse(path, kind_of(status.st_mode));
}

}  // namespace cuboct
