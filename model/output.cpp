// SPDX-License-Identifier: MIT
#include "model/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include "model/error.h"

namespace cuboct {
namespace {

InputError cannot_write(const std::string& path, int error) {
  return InputError(fmt::format("cannot write {}: {}", path, std::strerror(error)));
}

std::string temporary_beside(const std::string& path) { return fmt::format("{}.{}.tmp", path, getpid()); }

}  // namespace

void check_writable(const std::string& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) throw cannot_write(path, EISDIR);
  const std::string temporary = temporary_beside(path);
  const int file = open(temporary.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  if (file < 0) throw cannot_write(path, errno);
  close(file);
  unlink(temporary.c_str());
}

void make_directory(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (!error && !std::filesystem::is_directory(path))
    error = std::make_error_code(std::errc::not_a_directory);
  if (error)
    throw InputError(fmt::format("cannot make the directory {}: {}", path, std::strerror(error.value())));
}

void write_whole(const std::string& path, const std::function<void(const std::string&)>& write) {
  const std::string temporary = temporary_beside(path);
  try {
    write(temporary);
  } catch (...) {
    unlink(temporary.c_str());
    throw;
  }
  if (std::rename(temporary.c_str(), path.c_str()) != 0) {
    const int error = errno;
    unlink(temporary.c_str());
    throw cannot_write(path, error);
  }
}

void write_text(const std::string& path, const std::string& text) {
  write_whole(path, [&](const std::string& temporary) {
    std::FILE* file = std::fopen(temporary.c_str(), "wb");
    if (!file) throw cannot_write(path, errno);
    const bool all = std::fwrite(text.data(), 1, text.size(), file) == text.size();
    const int error = errno;
    if (std::fclose(file) != 0) throw cannot_write(path, errno);  // a full disk may only show here
    if (!all) throw cannot_write(path, error);
  });
}

}  // namespace cuboct
