// SPDX-License-Identifier: MIT
#include "model/body/particle_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "model/base/error.h"
#include "model/base/excerpt.h"
#include "model/base/input_file.h"
#include "model/base/resources.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

bool separates(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

}  // namespace

ParticleText::ParticleText(const std::string& path)
    : path_(path), text_(read_input(path, static_cast<uint64_t>(free_memory()) / 2)) {
  if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
  if (text_.starts_with("\x1f\x8b"))
    fail(size_t{0}, "a file packed by gzip is not read", "unpack it: gunzip");
}

std::string_view ParticleText::line() {
  const std::string_view rest = text().substr(std::min(at_, text_.size()));
  const size_t end = rest.find('\n');
  at_ += end == std::string_view::npos ? rest.size() : end + 1;
  std::string_view line = rest.substr(0, end);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

uint64_t ParticleText::skip_lines(uint64_t count) {
  uint64_t done = 0;
  for (; done < count && at_ < text_.size(); ++done) {
    const void* end = std::memchr(text_.data() + at_, '\n', text_.size() - at_);
    at_ =
        end == nullptr ? text_.size() : static_cast<size_t>(static_cast<const char*>(end) - text_.data()) + 1;
  }
  return done;
}

int ParticleText::line_at(size_t byte) const {
  const auto end = text_.begin() + static_cast<ptrdiff_t>(std::min(byte, text_.size()));
  return 1 + static_cast<int>(std::count(text_.begin(), end, '\n'));
}

void ParticleText::fail(size_t byte, const std::string& message, const std::string& hint) const {
  const std::string_view before = text().substr(0, byte);
  const size_t begin = before.rfind('\n') + 1;  // of none: 0
  std::string_view line = text().substr(begin);
  line = line.substr(0, line.find('\n'));
  if (line.ends_with('\r')) line.remove_suffix(1);
  const int number = line_at(byte), column = characters(text().substr(begin, byte - begin)) + 1;
  throw InputError(path_, number, column, message, hint, excerpt(line, number, column));
}

double ParticleText::number(std::string_view word, const char* what) const {
  std::string_view digits = word;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc() && stop == digits.data() + digits.size() && std::isfinite(value)) return value;
  if (error == std::errc::result_out_of_range && stop == digits.data() + digits.size()) {
    const size_t exponent = digits.find_first_of("eE");
    if (exponent != std::string_view::npos && digits.find('-', exponent) != std::string_view::npos) return 0;
    fail(word, fmt::format("{} is larger than any number that can be computed with", what));
  }
  fail(word, fmt::format("{} must be a number, not '{}'", what, shown_word(word)));
}

uint64_t ParticleText::count(std::string_view word, const char* what) const {
  uint64_t value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || stop != word.data() + word.size())
    fail(word, fmt::format("{} must be a whole number, not '{}'", what, shown_word(word)));
  return value;
}

std::string_view take_word(std::string_view& line) {
  size_t begin = 0;
  while (begin < line.size() && separates(line[begin])) ++begin;
  size_t end = begin;
  while (end < line.size() && !separates(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

bool is_blank_line(std::string_view line) { return std::ranges::all_of(line, separates); }

bool is_whole(std::string_view word) {
  return !word.empty() && std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
}

std::string shown_word(std::string_view word) {
  constexpr size_t kLongest = 40;
  return line_text(std::string(word.substr(0, kLongest))) + (word.size() > kLongest ? "..." : "");
}

}  // namespace cuboct
