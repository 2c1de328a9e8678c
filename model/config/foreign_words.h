// SPDX-License-Identifier: MIT
// What other tools for particles have as a key, and cuboct has elsewhere or not at all. A user who writes one
// is told where to go; docs/user/limits.md has each of these words, with what to take instead.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace cuboct {

struct ForeignWord {
  std::string_view words;    // separated by blanks
  std::string_view tables;   // the tables in which the word means this, separated by blanks; empty: in any
  std::string_view instead;  // the hint, a sentence without its full stop
  std::string_view section;  // of docs/user/limits.md, as an anchor; empty: the hint says it all
};

// Keys; and values of `kind`, where `tables` are what is of that kind: "law", "rule" or "constraint".
std::span<const ForeignWord> foreign_keys();
std::span<const ForeignWord> foreign_kinds();

// The hint for a word of one of the two lists in `table`: "run", "material.region"; the top of a file is "".
// Empty where the list has no such word.
std::string foreign_hint(std::span<const ForeignWord> list, std::string_view word, std::string_view table);

}  // namespace cuboct
