// SPDX-License-Identifier: MIT
#include "model/base/utf8.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/error.h"
#include "model/base/excerpt.h"

namespace cuboct {

void check_utf8(const std::string& text, const std::string& path) {
  const size_t at = std::min(not_utf8(text), text.find('\0'));
  if (at == std::string::npos) return;
  const std::string_view before = std::string_view(text).substr(0, at);
  const size_t end = before.rfind('\n');  // of the line before
  const int line = 1 + static_cast<int>(std::ranges::count(before, '\n'));
  const int column = 1 + characters(end == std::string_view::npos ? before : before.substr(end + 1));
  throw InputError(
      path, line, column,
      fmt::format("the byte 0x{:02x} is not UTF-8 text", static_cast<unsigned char>(text[at])),
      fmt::format("save the file as UTF-8: it may be in {} now", text[at] == 0 ? "UTF-16" : "Latin-1"),
      excerpt(line_of(text, line), line, column));
}

}  // namespace cuboct
