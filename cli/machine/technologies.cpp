// SPDX-License-Identifier: MIT
#include "cli/machine/technologies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "model/base/error.h"
#include "model/base/spelling.h"
#include "model/config/config.h"

namespace cuboct {
namespace {

constexpr std::array<std::pair<const char*, const char*>, 5> kBuiltIn{{{"cmos45", kCmos45Technology},
                                                                       {"cmos7", kCmos7Technology},
                                                                       {"osu018", kOsu018Technology},
                                                                       {"ice40", kIce40Technology},
                                                                       {"ecp5", kEcp5Technology}}};

[[noreturn]] void unknown(const std::string& what, const std::string& name,
                          const std::vector<std::string>& known, const std::string& more) {
  const std::string near = did_you_mean(name, known);
  throw InputError(fmt::format("unknown {} '{}'", what, name),
                   near.empty() ? "one of " + list_of(known) + more : near);
}

std::vector<LinkKind> links() { return parse_links(kLinksTechnology, "technologies/links.toml"); }

}  // namespace

std::vector<std::string> technology_names() {
  std::vector<std::string> names;
  for (const auto& [name, text] : kBuiltIn) names.emplace_back(name);
  return names;
}

Technology technology_named(const std::string& name) {
  for (const auto& [known, text] : kBuiltIn)
    if (name == known) return parse_technology(text, fmt::format("technologies/{}.toml", name));
  if (name.find('/') != std::string::npos || name.ends_with(".toml")) return read_technology(name);
  unknown("technology", name, technology_names(), ", or a file's path");
}

std::vector<std::string> link_names() {
  std::vector<std::string> names;
  for (const LinkKind& link : links()) names.push_back(link.name);
  return names;
}

std::vector<DeviceLinkKind> board_links(const std::string& file) {
  return file.empty() ? parse_board_links(kBoardsTechnology, "technologies/boards.toml")
                      : parse_board_links(read_config_text(file), file);
}

Technology with_link(Technology technology, const std::string& kind) {
  const std::vector<LinkKind> all = links();
  const auto found = std::ranges::find(all, kind, &LinkKind::name);
  if (found == all.end()) unknown("link", kind, link_names(), "");
  technology.at(Constant::link_bit) = found->figure;
  return technology;
}

}  // namespace cuboct
