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
#include <utility>

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

TextFile::TextFile(const std::string& temporary, std::string path)
    : file_(std::fopen(temporary.c_str(), "wb")), path_(std::move(path)) {
  if (!file_) throw cannot_write(path_, errno);
  std::setvbuf(file_, nullptr, _IOFBF, size_t{1} << 18);
}

TextFile::~TextFile() {
  if (file_) std::fclose(file_);
}

void TextFile::write(const char* text, size_t size) {
  if (std::fwrite(text, 1, size, file_) != size) throw cannot_write(path_, errno);
}

void TextFile::close() {
  if (std::fclose(std::exchange(file_, nullptr)) != 0) throw cannot_write(path_, errno);
}

void write_text(const std::string& path, const std::function<void(TextFile&)>& write) {
  write_whole(path, [&](const std::string& temporary) {
    TextFile file(temporary, path);
    write(file);
    file.close();
  });
}

void write_text(const std::string& path, const std::string& text) {
  write_text(path, [&](TextFile& file) { file.write(text); });
}

}  // namespace cuboct
