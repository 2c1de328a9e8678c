// SPDX-License-Identifier: MIT
// A text file of particles by lines and words. Each word is a view into the text, so that errors find its
// place.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace cuboct {

class ParticleText {
 public:
  // Reads the file: InputError where it cannot, or where half of the free memory does not hold it.
  explicit ParticleText(const std::string& path);
  ParticleText(const ParticleText&) = delete;
  ParticleText& operator=(const ParticleText&) = delete;

  const std::string& path() const { return path_; }
  std::string_view text() const { return text_; }
  bool ends() const { return at_ >= text_.size(); }
  size_t at() const { return at_; }
  void seek(size_t byte) { at_ = byte; }

  // The next line without its end, which is \n or \r\n; at the end of the text an empty one.
  std::string_view line();
  // Goes beyond `count` lines; how many there were.
  uint64_t skip_lines(uint64_t count);

  size_t byte_of(std::string_view word) const { return static_cast<size_t>(word.data() - text_.data()); }
  int line_at(size_t byte) const;  // its number, counted from 1

  // InputError that points to this byte.
  [[noreturn]] void fail(size_t byte, const std::string& message, const std::string& hint = {}) const;
  [[noreturn]] void fail(std::string_view word, const std::string& message,
                         const std::string& hint = {}) const {
    fail(byte_of(word), message, hint);
  }

  // A finite number; of one that is too small for a double 0. `what` it is, for errors: "the x of a
  // particle".
  double number(std::string_view word, const char* what) const;
  uint64_t count(std::string_view word, const char* what) const;

 private:
  std::string path_, text_;
  size_t at_ = 0;
};

// Takes the first word off a line; empty where none is left. It then stands at the line's end.
std::string_view take_word(std::string_view& line);
bool is_blank_line(std::string_view line);
// Digits alone.
bool is_whole(std::string_view word);
// A word of the file within a message, at most 40 characters of it.
std::string shown_word(std::string_view word);

}  // namespace cuboct
