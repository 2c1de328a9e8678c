// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_prefix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>

#include "model/base/error.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOwn = "cuboct_";  // every module and package begins so
// Leaves room for the rest of a file's name, and for what tools add.
constexpr size_t kLongest = 64;

bool in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '$'; }

// `text` with each name that begins with one of `of` beginning with `to` of that.
template <typename To>
std::string renamed(std::string_view text, const std::vector<std::string>& of, const To& to) {
  std::string result;
  for (size_t at = 0; at < text.size();) {
    const bool begins = at == 0 || !in_name(text[at - 1]);
    const auto found = !begins ? of.end() : std::ranges::find_if(of, [&](const std::string& name) {
      return text.substr(at).starts_with(name);
    });
    if (found == of.end()) {
      result += text[at++];
    } else {
      result += to(*found);
      at += found->size();
    }
  }
  return result;
}

}  // namespace

void check_prefix(const std::string& prefix) {
  const bool begins = !prefix.empty() && std::isalpha(static_cast<unsigned char>(prefix[0])) != 0;
  const bool goes_on = std::ranges::all_of(prefix, [](char c) { return in_name(c) && c != '$'; });
  if (begins && goes_on && prefix.size() <= kLongest) return;
  throw InputError(fmt::format("--prefix '{}': names of SystemVerilog cannot begin so", prefix),
                   fmt::format("at most {} letters, digits and '_', a letter first", kLongest));
}

RtlFiles with_prefix(const RtlFiles& files, const std::string& prefix) {
  if (prefix.empty()) return files;
  std::vector<std::string> names{std::string(kOwn)};
  for (const auto& [path, text] : files)
    if (path.ends_with(".hex")) names.push_back(fs::path(path).filename().string());
  const auto to = [&](const std::string& name) { return prefix + "_" + name; };
  RtlFiles all;
  for (const auto& [path, text] : files)
    all[renamed(path, names, to)] = path == "arch.toml" ? text : renamed(text, names, to);
  return all;
}

std::string prefix_of(const std::vector<std::string>& files) {
  constexpr std::string_view kLattice = "cuboct_lattice.sv";
  for (const std::string& file : files)
    if (const std::string name = fs::path(file).filename().string(); name.ends_with(kLattice))
      return name.substr(0, name.size() - kLattice.size());
  return "";
}

std::string without_prefix(const std::string& text, const std::string& prefix) {
  if (prefix.empty()) return text;
  return renamed(text, {prefix + std::string(kOwn)}, [](const std::string&) { return std::string(kOwn); });
}

}  // namespace cuboct
