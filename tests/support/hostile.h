// SPDX-License-Identifier: MIT
// Text of a stranger who means harm: what each place that text reaches would take for its own.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>

namespace cuboct::test {

// Every attempt that succeeds makes a file of this name in the working directory.
inline constexpr const char* kLoot = "cuboct_was_here";
// Whether one is there, and no longer.
inline bool take_loot(const std::filesystem::path& directory = ".") {
  std::error_code none;
  return std::filesystem::remove(directory / kLoot, none);
}

// A line's end and a command of gnuplot, quotes, command substitution, a macro, a variable of make, markup of
// gnuplot, tags, the end of a script element, entities, a terminal's title and colours (C0 and C1), a mark
// that turns the writing direction.
inline std::string hostile_text() {
  return fmt::format(
      "x\nsystem(\"touch {0}\") #'`touch {0}`$(touch {0})@a{{/Symbol s}}_2^3"
      "</title></script><script>alert(1)</script><img src=x "
      "onerror=alert(2)>\"&quot;]]>*/\\\x1b]0;owned\x07\xc2\x9b"
      "31m\xe2\x80\xae\r\t%s{{}}",
      kLoot);
}

// The same as a string of TOML, by hand: the code under test is not to write its own test.
inline std::string hostile_toml() {
  return fmt::format(
      "\"x\\nsystem(\\\"touch {0}\\\") #'`touch {0}`$(touch {0})@a{{/Symbol s}}_2^3"
      "</title></script><script>alert(1)</script><img src=x "
      "onerror=alert(2)>\\\"&quot;]]>*/\\\\\\u001b]0;owned\\u0007\\u009b"
      "31m\\u202e\\r\\t%s{{}}\"",
      kLoot);
}

// 256 particles under such a title.
inline std::string hostile_block() {
  return "title = " + hostile_toml() + R"(
units = "reduced"
mass = 1.0
[packing]
pitch = "relaxed"
[box]
cells = [4, 4, 4]
periodic = "xyz"
[law]
kind = "lj"
epsilon = 1.0
sigma = 1.0
cutoff = 1.8
)";
}

// Whether a terminal would show all of it: no controls but '\n', no C1, no mark of writing direction.
inline bool is_tame(const std::string& text) {
  for (size_t k = 0; k < text.size(); ++k) {
    const auto c = static_cast<unsigned char>(text[k]);
    if ((c < 0x20 && c != '\n') || c == 0x7f) return false;
    if (c == 0xc2 && k + 1 < text.size() && static_cast<unsigned char>(text[k + 1]) < 0xa0) return false;
  }
  return text.find("\xe2\x80\xae") == std::string::npos;
}

}  // namespace cuboct::test
