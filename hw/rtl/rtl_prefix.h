// SPDX-License-Identifier: MIT
// Names of an emitted project that begin with a word of the user's, so that several machines stand in one
// design.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace cuboct {

// An emitted project: text by path.
using RtlFiles = std::map<std::string, std::string>;

// Throws InputError where names of SystemVerilog cannot begin so.
void check_prefix(const std::string& prefix);

// Each module, package and file cuboct_X is PREFIX_cuboct_X, and so are the bench's memories PREFIX_X.hex,
// wherever the project names them. What has the user's text, arch.toml, stays as it is, as all does where
// `prefix` is empty.
RtlFiles with_prefix(const RtlFiles& files, const std::string& prefix);

// "PREFIX_" of the project that has these files, or nothing.
std::string prefix_of(const std::vector<std::string>& files);

// A file of such a project with the names that it has without the prefix.
std::string without_prefix(const std::string& text, const std::string& prefix);

}  // namespace cuboct
