// SPDX-License-Identifier: MIT
#include "model/base/directory_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "model/base/error.h"
#include "model/base/names_in.h"
#include "model/base/output.h"

namespace cuboct {
namespace {

// What the holder wrote, as one line; anyone may have edited it.
std::string holder_of(int file) {
  char text[100];
  const ssize_t size = pread(file, text, sizeof text, 0);
  std::string line(text, size > 0 ? static_cast<size_t>(size) : 0);
  line = line.substr(0, line.find('\n'));
  for (char& c : line)
    if (c < ' ' || c > '~') c = '?';
  return line.empty() ? "another process" : line;
}

// Whether the file of this name is the one that is open: its holder may have removed it in the meantime.
bool is_at(int file, const std::string& path) {
  struct stat open_file {
  }, named{};
  return fstat(file, &open_file) == 0 && stat(path.c_str(), &named) == 0 &&
         open_file.st_ino == named.st_ino && open_file.st_dev == named.st_dev;
}

// What temporary_beside (output.h) named for a process that is no more: the kill that ended it left it.
void remove_what_dead_ones_left(const std::string& directory) {
  for (const std::string& name : names_in(directory)) {
    constexpr std::string_view kEnd = ".tmp";
    if (!name.ends_with(kEnd)) continue;
    const size_t last = name.size() - kEnd.size(), dot = name.rfind('.', last - 1);
    if (dot == std::string::npos || dot == 0) continue;
    pid_t process = 0;
    const auto [stop, error] = std::from_chars(name.data() + dot + 1, name.data() + last, process);
    if (error != std::errc() || stop != name.data() + last || process <= 0) continue;
    if (kill(process, 0) != 0 && errno == ESRCH) unlink((directory + "/" + name).c_str());
  }
}

}  // namespace

DirectoryLock::DirectoryLock(const std::string& directory, const std::string& work)
    : directory_(directory), path_(directory + "/.lock"), made_(!std::filesystem::exists(directory)) {
  make_directory(directory);
  do {
    if (file_ >= 0) close(file_);
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0)
      throw InputError(
          fmt::format("cannot write into the directory {}: {}", directory, std::strerror(errno)));
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      const std::string holder = error == EWOULDBLOCK ? holder_of(file_) : "";
      close(file_);
      if (error != EWOULDBLOCK)
        throw InputError(fmt::format("cannot lock {}: {}", path_, std::strerror(error)));
      throw InputError(fmt::format("{} is in use by {}", directory, holder),
                       "another --out, or wait for its end");
    }
  } while (!is_at(file_, path_));
  const std::string text = fmt::format("process {}, '{}'\n", getpid(), work);
  // For people alone: on a full disk the lock holds without.
  static_cast<void>(ftruncate(file_, 0) == 0 && pwrite(file_, text.data(), text.size(), 0) > 0);
  remove_what_dead_ones_left(directory);
}

DirectoryLock::~DirectoryLock() {
  unlink(path_.c_str());
  close(file_);
  if (made_) rmdir(directory_.c_str());  // where it is empty
}

bool is_locked(const std::string& directory) {
  const int file = open((directory + "/.lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool locked = flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(file);
  return locked;
}

}  // namespace cuboct
