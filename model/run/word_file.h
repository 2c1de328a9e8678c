// SPDX-License-Identifier: MIT
// Files of 64-bit little-endian words with a running hash over them: what checkpoints and journals are made
// of.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "model/base/hash.h"

namespace cuboct {

static_assert(std::endian::native == std::endian::little, "words are written as they lie in memory");

// A place in a word file: how many words lie before it, and their hash.
struct WordMark {
  uint64_t words = 0;
  uint64_t hash = 0;
  bool operator==(const WordMark&) const = default;
};

class WordWriter {
 public:
  // Makes the file, or empties it. Throws InputError.
  explicit WordWriter(const std::string& path);
  // Goes on behind `end`; what lies there is cut off. The file is this process's alone until it ends: throws
  // InputError where another one has it.
  WordWriter(const std::string& path, const WordMark& end);
  ~WordWriter();
  WordWriter(const WordWriter&) = delete;
  WordWriter& operator=(const WordWriter&) = delete;

  void word(uint64_t value);
  void number(double value) { word(std::bit_cast<uint64_t>(value)); }
  void words(std::span<const uint64_t> values);
  // On the disk when it returns. Throws InputError where the disk is full.
  void sync();

  WordMark mark() const { return {written_, hash_.value()}; }

 private:
  WordWriter(const std::string& path, const WordMark& end, bool exclusive);
  void flush();

  std::string path_;
  int file_ = -1;
  std::vector<uint64_t> buffer_;
  uint64_t written_ = 0;
  Hash hash_;
};

class WordReader {
 public:
  // Throws InputError where the file cannot be read.
  explicit WordReader(const std::string& path);
  ~WordReader();
  WordReader(const WordReader&) = delete;
  WordReader& operator=(const WordReader&) = delete;

  uint64_t size() const { return size_; }  // whole words in the file
  bool ragged() const { return ragged_; }  // bytes are left over behind them
  // Throws InputError ("... is damaged: ...") behind the end.
  uint64_t word();
  double number() { return std::bit_cast<double>(word()); }
  // The number of things that follow, of at least `words_each`: InputError where the file is too short for
  // them.
  uint64_t count(uint64_t words_each);
  // InputError where the file is too short for so many.
  void expect(uint64_t things, uint64_t words_each) const;
  void words(std::span<uint64_t> values);
  void seek(uint64_t word);  // the running hash goes on as if the words between were not there

  WordMark mark() const { return {read_, hash_.value()}; }

 private:
  void fill();

  std::string path_;
  std::FILE* file_ = nullptr;
  std::vector<uint64_t> buffer_;
  size_t next_ = 0;
  uint64_t size_ = 0, read_ = 0;
  bool ragged_ = false;
  Hash hash_;
};

// The directory's entry of a file is on the disk when it returns.
void sync_directory_of(const std::string& path);

}  // namespace cuboct
