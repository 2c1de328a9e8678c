// SPDX-License-Identifier: MIT
#include "model/base/excerpt.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/text.h"

namespace cuboct {
namespace {

// Characters that are shown of a line, and how many of them before the column where it is cut.
constexpr size_t kShown = 80, kBefore = 50;

bool continues(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; }

std::string_view without_end(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

size_t next(std::string_view line, size_t byte) {
  do ++byte;
  while (byte < line.size() && continues(line[byte]));
  return byte;
}

size_t before(std::string_view line, size_t byte) {
  do --byte;
  while (byte > 0 && continues(line[byte]));
  return byte;
}

// At most `most` characters on.
size_t forward(std::string_view line, size_t byte, size_t most) {
  for (size_t k = 0; k < most && byte < line.size(); ++k) byte = next(line, byte);
  return byte;
}

size_t back(std::string_view line, size_t byte, size_t most) {
  for (size_t k = 0; k < most && byte > 0; ++k) byte = before(line, byte);
  return byte;
}

std::string shown(std::string_view part) {
  std::string text(part);
  std::ranges::replace(text, '\t', ' ');
  return line_text(text);
}

}  // namespace

int characters(std::string_view text) {
  return static_cast<int>(std::ranges::count_if(text, [](char byte) { return !continues(byte); }));
}

std::string_view line_of(std::string_view text, int number) {
  for (int line = 1; line < number; ++line) {
    const size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return without_end(text.substr(0, text.find('\n')));
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  for (;;) {
    const size_t end = text.find('\n');
    lines.push_back(without_end(text.substr(0, end)));
    if (end == std::string_view::npos) return lines;
    text.remove_prefix(end + 1);
  }
}

std::string excerpt(std::string_view line, int number, int column) {
  if (column < 1 || line.find_first_not_of(" \t\r") == std::string_view::npos) return {};
  const size_t at = forward(line, 0, static_cast<size_t>(column) - 1);
  size_t begin = 0, end = forward(line, 0, kShown);
  if (end < line.size()) {
    begin = back(line, at, kBefore);
    end = forward(line, begin, kShown);
    begin = back(line, end, kShown);  // all of it, where the column is near the end
  }
  const std::string left = (begin > 0 ? "..." : "") + shown(line.substr(begin, at - begin));
  const std::string right = shown(line.substr(at, end - at)) + (end < line.size() ? "..." : "");
  const std::string margin = fmt::format("{:>4}", number);
  return fmt::format("{} | {}{}\n{} | {}^", margin, left, right, std::string(margin.size(), ' '),
                     std::string(static_cast<size_t>(characters(left)), ' '));
}

}  // namespace cuboct
