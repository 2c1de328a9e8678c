// SPDX-License-Identifier: MIT
// A TOML text with some of its values replaced: how a study varies a scene or an arch, and how a choice of
// settings is written down. Everything that is not named stays as the user wrote it, comments included.
#pragma once

#include <string>
#include <vector>

namespace cuboct {

struct Change {
  std::string key;    // "run.dt_safety", "node.cell_edge"; tables of an array by index: "constraint.0.kp"
  std::string value;  // TOML text: `0.1`, `"0.5 mm"`; empty: the key goes

  bool operator==(const Change&) const = default;
};

// `path` stands in messages. A key that is not there yet is added to its table, a table that is not there to
// the end. Throws InputError where the text is no TOML, a value is none, or a key runs through something that
// is no table.
std::string with_changes(const std::string& text, const std::string& path,
                         const std::vector<Change>& changes);

// The text for another directory: what its keys `file` name from the directory of `path` gets whole paths.
std::string with_whole_paths(const std::string& text, const std::string& path);

}  // namespace cuboct
