// SPDX-License-Identifier: MIT
#include "study/sweep/settings.h"

#include <fmt/format.h>

#include "hw/engine/engines.h"
#include "hw/engine/scene_engine.h"
#include "model/base/error.h"
#include "model/config/config.h"

namespace cuboct::study {
Base read_base(const std::string& scene_path, const std::string& arch_path) {
  Base base{scene_path, read_config_text(scene_path), arch_path,
            arch_path.empty() ? "" : read_config_text(arch_path)};
  resolve(base, {});
  return base;
}

bool is_reduced(const Base& base) {
  const auto units = parse_config(base.scene_text, base.scene_path).find("units");
  return units && units->is_string() && units->string() == "reduced";
}

const std::vector<std::string>& arithmetic_names() {
  static const std::vector<std::string> names{"float64", "float32", "fixed"};
  return names;
}

std::string Settings::numbers_key() const {
  std::string key = fmt::format("{} {} {}", engine, name_of(arithmetic),
                                integrator == Integrator::semi_implicit_euler ? "euler" : "verlet");
  if (arithmetic != Arithmetic::fixed) key += fmt::format(" threads={}", threads);
  for (const Change& change : scene) key += fmt::format(" {}={}", change.key, change.value);
  for (const Change& change : arch) key += fmt::format(" arch.{}={}", change.key, change.value);
  return key;
}

std::string Settings::key() const {
  return arithmetic == Arithmetic::fixed ? fmt::format("{} threads={}", numbers_key(), threads)
                                         : numbers_key();
}

bool on_gpu(const Settings& settings) {
  const EngineRow* row = find_engine(settings.engine);
  return row && row->devices;
}

Case resolve(const Base& base, const Settings& settings) {
  const bool fixed = settings.arithmetic == Arithmetic::fixed;
  const EngineRow* row = find_engine(settings.engine);
  if (row && !(fixed ? row->bits : row->real))
    throw InputError(fmt::format("engine '{}' does not know {} arithmetic", settings.engine,
                                 name_of(settings.arithmetic)));
  if (settings.integrator != Integrator::semi_implicit_euler && (fixed || on_gpu(settings)))
    throw InputError(
        fmt::format("{} knows the integrator 'euler' only", fixed ? "fixed arithmetic" : "the gpu engine"));
  Case c{settings, {}, {}, with_changes(base.scene_text, base.scene_path, settings.scene), {}};
  c.scene = parse_scene(c.scene_text, base.scene_path);
  const std::string arch_path = base.arch_path.empty() ? "(default arch)" : base.arch_path;
  const std::string arch_text = base.arch_text.empty() ? "name = \"default\"\n" : base.arch_text;
  c.arch_text = with_changes(arch_text, arch_path, settings.arch);
  c.arch = parse_arch(c.arch_text, arch_path);
  if (on_gpu(settings)) check_runs(c.scene, c.arch, settings.engine);
  return c;
}

}  // namespace cuboct::study
