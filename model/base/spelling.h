// SPDX-License-Identifier: MIT
// Nearest spelling of a misspelt name, for hints.
#pragma once

#include <string>
#include <vector>

namespace cuboct {

// The candidate with the least edit distance (insert, delete, replace, swap of two neighbours; a wrong case
// counts half), the first of equals; empty where none is nearer than a third of the name's length (at least
// one edit is always allowed).
std::string nearest_spelling(const std::string& name, const std::vector<std::string>& candidates);

// "did you mean 'capacity'?", or empty.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates);

// "a, b or c".
std::string list_of(const std::vector<std::string>& names);

}  // namespace cuboct
