// SPDX-License-Identifier: MIT
#include "synth/input_key.h"

#include <fmt/format.h>

#include <sstream>

namespace cuboct::synth {

// With its length, so that two texts are not the same two cut elsewhere.
InputKey& InputKey::add(std::string_view text) {
  hash_.add(static_cast<int64_t>(text.size()));
  for (const char c : text) hash_.add(c);
  return *this;
}

InputKey& InputKey::add_code(const std::string& text) {
  std::string code;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("//")) code.append(line).append("\n");
  return add(code);
}

std::string InputKey::text() const { return fmt::format("{:016x}", hash_.value()); }

}  // namespace cuboct::synth
