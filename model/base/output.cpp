// SPDX-License-Identifier: MIT
#include "model/base/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "model/base/error.h"

namespace cuboct {
namespace {

InputError cannot_write(const std::string& path, int error) {
  return InputError(fmt::format("cannot write {}: {}", path, std::strerror(error)));
}

}  // namespace

std::string temporary_beside(const std::string& path) { return fmt::format("{}.{}.tmp", path, getpid()); }

int reserve(const std::string& path, uint64_t from, uint64_t bytes) {
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return errno;
  struct stat status {};
  int error = 0;
  if (fstat(file, &status) != 0) {
    error = errno;
  } else {
    while ((error = posix_fallocate(file, static_cast<off_t>(from), static_cast<off_t>(bytes))) == EINTR) {
    }
    // What it took before it met the end of the disk goes back.
    if (error != 0 && ftruncate(file, status.st_size) != 0) error = errno;
  }
  close(file);
  return error;
}

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

std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", path));
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write_whole(const std::string& path, const std::function<void(const std::string&)>& write) {
  const std::string temporary = temporary_beside(path);
  try {
    write(temporary);
  } catch (...) {
    discard(temporary);
    throw;
  }
  rename_whole(temporary, path);
}

void discard(const std::string& path) {
  if (truncate(path.c_str(), 0) != 0 && errno == ENOENT) return;
  unlink(path.c_str());
}

void rename_whole(const std::string& temporary, const std::string& path) {
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

GrowingFile::GrowingFile(std::string path, const std::string& head, std::string tail)
    : path_(std::move(path)),
      tail_(std::move(tail)),
      file_(open(path_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666)) {
  if (file_ < 0) throw cannot_write(path_, errno);
  try {
    write(head);
    commit();
  } catch (...) {
    close(file_);
    throw;
  }
}

GrowingFile::~GrowingFile() { close(file_); }

void GrowingFile::write(const char* text, size_t size) {
  buffer_.append(text, size);
  if (buffer_.size() >= size_t{1} << 18) flush();
}

void GrowingFile::commit() {
  const size_t body = buffer_.size();
  buffer_ += tail_;
  const off_t end = end_ + static_cast<off_t>(body);
  flush();
  committed_ = end_ = end;
}

void GrowingFile::flush() {
  const std::string text = std::exchange(buffer_, {});
  for (size_t done = 0; done < text.size();) {
    const ssize_t now = pwrite(file_, text.data() + done, text.size() - done, end_);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) {
      const int error = now < 0 ? errno : ENOSPC;
      end_ = committed_;
      // The tail's room is the file's already.
      if (pwrite(file_, tail_.data(), tail_.size(), end_) < 0 ||
          ftruncate(file_, end_ + static_cast<off_t>(tail_.size())) != 0)
        throw cannot_write(path_, errno);
      throw cannot_write(path_, error);
    }
    done += static_cast<size_t>(now);
    end_ += now;
  }
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
