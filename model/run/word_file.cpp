// SPDX-License-Identifier: MIT
#include "model/run/word_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "model/base/error.h"
#include "model/base/input_file.h"

namespace cuboct {
namespace {

constexpr uint64_t kBuffer = uint64_t{1} << 17;  // words: 1 MiB

InputError cannot(const char* what, const std::string& path, int error) {
  return InputError(fmt::format("cannot {} {}: {}", what, path, std::strerror(error)));
}

// Ctrl-C may break off an fsync; it must not break off a checkpoint.
int sync_file(int file) {
  int result;
  while ((result = fsync(file)) != 0 && errno == EINTR) {
  }
  return result;
}

}  // namespace

WordWriter::WordWriter(const std::string& path) : WordWriter(path, WordMark{}, false) {}

WordWriter::WordWriter(const std::string& path, const WordMark& end) : WordWriter(path, end, true) {}

WordWriter::WordWriter(const std::string& path, const WordMark& end, bool exclusive)
    : path_(path), file_(open(path.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0666)), written_(end.words) {
  if (file_ < 0) throw cannot("write", path, errno);
  const auto bytes = static_cast<off_t>(end.words * sizeof(uint64_t));
  try {
    if (exclusive && flock(file_, LOCK_EX | LOCK_NB) != 0)
      throw InputError(fmt::format("{} is in use by another run", path));
    if (ftruncate(file_, bytes) != 0 || lseek(file_, bytes, SEEK_SET) < 0) throw cannot("write", path, errno);
  } catch (...) {
    close(file_);
    throw;
  }
  hash_.resume(end.hash);
  buffer_.reserve(kBuffer);
}

WordWriter::~WordWriter() {
  if (file_ >= 0) close(file_);
}

void WordWriter::word(uint64_t value) {
  hash_.add(static_cast<int64_t>(value));
  buffer_.push_back(value);
  ++written_;
  if (buffer_.size() == kBuffer) flush();
}

void WordWriter::words(std::span<const uint64_t> values) {
  for (const uint64_t value : values) word(value);
}

void WordWriter::flush() {
  const char* data = reinterpret_cast<const char*>(buffer_.data());
  size_t left = buffer_.size() * sizeof(uint64_t);
  while (left > 0) {
    const ssize_t done = write(file_, data, left);
    if (done < 0 && errno != EINTR) throw cannot("write", path_, errno);
    if (done <= 0) continue;
    data += done;
    left -= static_cast<size_t>(done);
  }
  buffer_.clear();
}

void WordWriter::sync() {
  flush();
  if (sync_file(file_) != 0) throw cannot("write", path_, errno);
}

WordReader::WordReader(const std::string& path) : path_(path) {
  check_is_file(path);
  file_ = std::fopen(path.c_str(), "rb");
  struct stat status {};
  if (!file_) throw cannot("read", path, errno);
  if (fstat(fileno(file_), &status) != 0) {
    const int error = errno;
    std::fclose(file_);
    throw cannot("read", path, error);
  }
  size_ = static_cast<uint64_t>(status.st_size) / sizeof(uint64_t);
  ragged_ = static_cast<uint64_t>(status.st_size) % sizeof(uint64_t) != 0;
}

WordReader::~WordReader() { std::fclose(file_); }

void WordReader::fill() {
  buffer_.resize(std::min(kBuffer, size_));
  buffer_.resize(std::fread(buffer_.data(), sizeof(uint64_t), buffer_.size(), file_));
  next_ = 0;
  if (buffer_.empty())
    throw InputError(fmt::format("{} is damaged: it ends after {} of its words", path_, read_));
}

uint64_t WordReader::word() {
  if (next_ == buffer_.size()) fill();
  const uint64_t value = buffer_[next_++];
  hash_.add(static_cast<int64_t>(value));
  ++read_;
  return value;
}

uint64_t WordReader::count(uint64_t words_each) {
  const uint64_t said = word();
  expect(said, words_each);
  return said;
}

void WordReader::expect(uint64_t things, uint64_t words_each) const {
  if (things > (size_ - std::min(size_, read_)) / words_each)
    throw InputError(fmt::format("{} is damaged: {} things of {} words do not fit behind its word {}", path_,
                                 things, words_each, read_));
}

void WordReader::words(std::span<uint64_t> values) {
  for (uint64_t& value : values) value = word();
}

void WordReader::seek(uint64_t word) {
  if (fseeko(file_, static_cast<off_t>(word * sizeof(uint64_t)), SEEK_SET) != 0)
    throw cannot("read", path_, errno);
  buffer_.clear();
  next_ = 0;
  read_ = word;
}

void sync_directory_of(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::absolute(path).parent_path();
  const int directory = open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory < 0) return;  // a directory that may not be read: its entries reach the disk in their time
  sync_file(directory);
  close(directory);
}

}  // namespace cuboct
