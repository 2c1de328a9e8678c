// SPDX-License-Identifier: MIT
#include "study/sweep/changed_base.h"

#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "model/base/input_file.h"
#include "study/sweep/axes.h"

namespace cuboct::study {
namespace {

namespace fs = std::filesystem;

// Paths in a study count from its own directory.
std::string path_beside(const std::string& study, const std::string& path) {
  if (path.empty() || fs::path(path).is_absolute()) return path;
  return (fs::path(study).parent_path() / path).lexically_normal().string();
}

// A file that is not there is told where the study names it.
std::string file_named_by(const ConfigValue& value, const std::string& study) {
  std::string file = path_beside(study, value.string());
  if (!is_file(file))
    value.fail(fmt::format("'{}' names no file: {}", value.key(), file),
               "paths count from the study's directory");
  return file;
}

}  // namespace

Base read_changed_base(const ConfigTable& root, const std::string& path) {
  const auto arch_file = root.find("arch");
  Base base =
      read_base(file_named_by(root.at("scene"), path), arch_file ? file_named_by(*arch_file, path) : "");
  const auto change = root.table_at("change");
  if (!change) return base;
  std::vector<Change> scene, arch;
  for (const Leaf& leaf : leaves(*change)) {
    const bool of_arch = leaf.key.starts_with("arch.");
    (of_arch ? arch : scene).push_back({of_arch ? leaf.key.substr(5) : leaf.key, toml_text(leaf.value)});
  }
  base.scene_text = with_changes(base.scene_text, base.scene_path, scene);
  if (!arch.empty()) {
    if (base.arch_text.empty()) base.arch_text = "name = \"study\"\n";
    base.arch_text = with_changes(base.arch_text, base.arch_path, arch);
  }
  return base;
}

}  // namespace cuboct::study
