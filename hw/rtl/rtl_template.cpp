// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_template.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace cuboct {
namespace {

bool is_name(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= 'A' && c <= 'Z') || c == '_'; });
}

}  // namespace

std::string fill(std::string_view text, const std::map<std::string, std::string, std::less<>>& values) {
  std::string filled;
  for (size_t at = 0; at < text.size();) {
    const size_t open = text.find('@', at), close = open == text.npos ? text.npos : text.find('@', open + 1);
    filled += text.substr(at, open == text.npos ? text.npos : open - at);
    if (open == text.npos) break;
    const std::string_view name =
        close == text.npos ? std::string_view() : text.substr(open + 1, close - open - 1);
    if (!is_name(name)) {  // as of always_ff @(posedge clk_i)
      filled += '@';
      at = open + 1;
      continue;
    }
    const auto value = values.find(name);
    if (value == values.end()) throw std::logic_error(fmt::format("nothing fills @{}@", name));
    filled += value->second;
    at = close + 1;
  }
  return filled;
}

std::string literal(int64_t value, int bits) {
  const uint64_t mask = bits == 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
  return fmt::format("{}'h{:x}", bits, static_cast<uint64_t>(value) & mask);
}

}  // namespace cuboct
