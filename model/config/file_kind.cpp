// SPDX-License-Identifier: MIT
#include "model/config/file_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include "model/base/text.h"

namespace cuboct {
namespace {

using Keys = std::vector<std::string_view>;

struct Row {
  FileKind kind;
  const char* name;       // completes "this is ..."
  const char* taker;      // a format: {} is the file as a word of a shell
  std::vector<Keys> has;  // of each list one key at least
  Keys lacks = {};        // none of these
};

const Keys kOfSettings{"sweep", "search", "figure", "truth", "samples", "speed"};

// A file is of the first kind that fits.
const std::vector<Row>& kinds() {
  static const std::vector<Row> rows{
      {FileKind::run_record,
       "the record of a run",
       "'cuboct report' and 'cuboct picture' take its directory",
       {{"scene"}, {"engine"}, {"state"}}},
      {FileKind::machine_study,
       "a study of machines",
       "'cuboct explore {}' takes it",
       {{"machines", "evolve"}}},
      {FileKind::potential_fit, "a fit of a potential", "'cuboct fit {}' takes it", {{"fit"}, {"target"}}},
      {FileKind::curve_fit, "a fit of a law to a curve", "'cuboct fit {}' takes it", {{"scene"}, {"target"}}},
      {FileKind::study,
       "a study of settings",
       "'cuboct explore {}' takes it",
       {{"scene"}, kOfSettings},
       {"target", "machines", "evolve"}},
      {FileKind::learn_study,
       "a study of a learned kernel",
       "'cuboct learn {}' takes it",
       {{"sheet"}, {"grid"}}},
      {FileKind::element_study,
       "a study of elements",
       "'cuboct multiscale {}' takes it",
       {{"material"}, {"mesh"}}},
      {FileKind::technology,
       "a technology",
       "'cuboct energy SCENE --technology {}' takes it",
       {{"add_bit", "multiply_bit2", "register_bit", "clock_bit", "memory_read"}}},
      {FileKind::rule,
       "a rule",
       "a scene takes it: rule = \"FILE\"",
       {{"round"}, {"reach", "parameters", "particle"}}},
      {FileKind::scene,
       "a scene",
       "'cuboct run {}' takes it",
       {{"law", "rule", "packing", "crystal", "particle", "particles"}},
       {"round"}},
      {FileKind::arch,
       "an arch file",
       "--arch {} gives it to a scene",
       {{"node", "link", "widths", "table", "plan"}},
       {"round"}}};
  return rows;
}

bool any(const std::vector<std::string>& names, const Keys& keys) {
  return std::ranges::any_of(keys, [&](std::string_view key) { return std::ranges::count(names, key) > 0; });
}

bool fits(const Row& kind, const std::vector<std::string>& names) {
  return std::ranges::all_of(kind.has, [&](const Keys& keys) { return any(names, keys); }) &&
         !any(names, kind.lacks);
}

}  // namespace

void refuse_other_kind(FileKind wanted, const std::string& text, const std::string& path) {
  std::optional<ConfigTable> root;
  try {
    root = parse_config(text, path);
  } catch (const InputError&) {
    return;  // no TOML
  }
  const std::vector<std::string> names = root->names();
  const Row& asked = *std::ranges::find(kinds(), wanted, &Row::kind);
  if (fits(asked, names)) return;
  const auto found = std::ranges::find_if(kinds(), [&](const Row& kind) { return fits(kind, names); });
  if (found == kinds().end()) return;
  for (const std::string& name : names)
    if (any({name}, found->has.front()))
      root->at(name).fail(fmt::format("this is {}, not {}", found->name, asked.name),
                          fmt::format(fmt::runtime(found->taker), shell_word(path)));
}

}  // namespace cuboct
