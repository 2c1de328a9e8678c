// SPDX-License-Identifier: MIT
#include "study/sweep/axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <optional>

#include "hw/engine/engines.h"
#include "model/base/error_parts.h"
#include "model/base/text.h"

namespace cuboct::study {
namespace {

using Set = std::function<void(Settings&)>;

void put(std::vector<Change>& changes, const std::string& key, const std::string& value) {
  std::erase_if(changes, [&](const Change& change) { return change.key == key; });
  changes.push_back({key, value});
}

// "arch.widths.guard" goes to the arch, all else to the scene.
Set change_of(const std::string& key, const std::string& value) {
  return [key, value](Settings& settings) {
    if (key.starts_with("arch."))
      put(settings.arch, key.substr(5), value);
    else
      put(settings.scene, key, value);
  };
}

std::optional<int> whole(const std::vector<Change>& changes, const std::string& key) {
  for (const Change& change : changes)
    if (change.key == key && !change.value.empty() && change.value[0] != '"') return std::stoi(change.value);
  return std::nullopt;
}

// Positions or velocities of another format: what counts in their bits keeps its range, so that one width can
// be swept by itself.
void fit_widths(Settings& settings, const Widths& base) {
  if (base.position_frac == kAutomatic || base.guard == kAutomatic)
    return;  // as are those that count in their bits
  const auto now = [&](const char* key, int otherwise) {
    return whole(settings.arch, std::string("widths.") + key).value_or(otherwise);
  };
  const auto follow = [&](const char* key, int from, int to) {
    if (from == kAutomatic) return;
    std::erase_if(settings.arch, [&](const Change& c) { return c.key == std::string("widths.") + key; });
    if (to != from) settings.arch.push_back({std::string("widths.") + key, std::to_string(to)});
  };
  const int position = now("position_frac", base.position_frac);
  const int velocity = position + now("guard", base.guard);
  const int wider = velocity - base.velocity_frac();
  follow("velocity_bits", base.velocity_bits, base.velocity_bits + wider);
  follow("sum_bits", base.sum_bits, std::min(48, base.sum_bits + wider));
  follow("displacement_bits", base.displacement_bits, std::min(40, base.displacement_bits + wider));
  follow("difference_frac", base.difference_frac, std::min(base.difference_frac, position));
  const int relative = std::min(base.relative_velocity_frac, velocity);
  follow("relative_velocity_frac", base.relative_velocity_frac, relative);
  follow("relative_velocity_bits", base.relative_velocity_bits,
         base.relative_velocity_bits + relative - base.relative_velocity_frac);
}

struct Key {
  const char* name;
  const char* target;    // key of the scene, of the arch ("arch."); null: of the settings themselves
  bool alone = true;     // a value that is wrong by itself is a mistake
  bool machine = false;  // no error depends on it

  bool is_of(KeysOf keys) const { return keys == KeysOf::machines ? target != nullptr : !machine; }
};

// In the order in which axes nest, the last one fastest.
constexpr Key kKeys[] = {
    {"engine", nullptr},
    {"arithmetic", nullptr},
    {"integrator", nullptr},
    {"pitch", "packing.pitch", false},
    {"cutoff", "law.cutoff", false},
    {"dt", "run.dt", false},
    {"dt_safety", "run.dt_safety"},
    {"cell_edge", "arch.node.cell_edge", false},
    {"capacity", "arch.node.capacity"},
    {"position_frac", "arch.widths.position_frac"},
    {"guard", "arch.widths.guard"},
    {"difference_frac", "arch.widths.difference_frac"},
    {"velocity_bits", "arch.widths.velocity_bits"},
    {"relative_velocity_frac", "arch.widths.relative_velocity_frac"},
    {"relative_velocity_bits", "arch.widths.relative_velocity_bits"},
    {"strength_bits", "arch.widths.strength_bits"},
    {"sum_bits", "arch.widths.sum_bits"},
    {"displacement_bits", "arch.widths.displacement_bits"},
    {"scale_frac", "arch.widths.scale_frac"},
    {"filter_frac", "arch.widths.filter_frac"},
    {"gain_frac", "arch.widths.gain_frac"},
    {"table_shape", "arch.table.shape"},
    {"degree", "arch.table.degree"},
    {"index_bits", "arch.table.index_bits"},
    {"fraction_bits", "arch.table.fraction_bits"},
    {"threads", nullptr},
    {"brick", "arch.node.brick", false, true},
    {"filter_lanes", "arch.node.filter_lanes", true, true},
    {"force_pipes", "arch.node.force_pipes", true, true},
    {"multipliers", "arch.node.multipliers", true, true},
    {"memories", "arch.node.memories", true, true},
    {"halos", "arch.node.halos", true, true},
    {"streamers", "arch.node.streamers", true, true},
    {"queue_depth", "arch.node.queue_depth", true, true},
    {"overlap", "arch.node.overlap", true, true},
    {"link_bits", "arch.link.bits", true, true},
    {"link_check", "arch.link.check", true, true},
};

// What one value of one key does.
Set set_of(const Key& key, const ConfigValue& value, const Widths& widths) {
  const std::string name = key.name;
  if (name == "engine") {
    const auto names = engines_that([](auto& row) { return row.studied; });
    const std::string engine = names[value.choice("engine", names)];
    return [engine](Settings& settings) {
      settings.engine = engine;
      settings.arithmetic = engine_row(engine).bits ? Arithmetic::fixed : Arithmetic::float64;
    };
  }
  if (name == "arithmetic") {
    const auto arithmetic = static_cast<Arithmetic>(value.choice("arithmetic", arithmetic_names()));
    return [arithmetic](Settings& settings) {
      settings.arithmetic = arithmetic;
      if (!on_gpu(settings)) settings.engine = default_engine(arithmetic);
    };
  }
  if (name == "integrator") {
    const auto integrator = static_cast<Integrator>(value.choice("integrator", {"euler", "verlet"}));
    return [integrator](Settings& settings) { settings.integrator = integrator; };
  }
  if (name == "threads") {
    const int threads = static_cast<int>(value.integer(1, 4096));
    return [threads](Settings& settings) { settings.threads = threads; };
  }
  Set change = change_of(key.target, toml_text(value));
  // "auto" with its safety and a given dt rule each other out.
  if (name == "dt") return [change](Settings& s) { change_of("run.dt_safety", "")(s), change(s); };
  if (name == "dt_safety") return [change](Settings& s) { change_of("run.dt", "\"auto\"")(s), change(s); };
  if (name == "position_frac" || name == "guard")
    return [change, widths](Settings& s) { change(s), fit_widths(s, widths); };
  return change;
}

Widths widths_of(const Base& base) { return resolve(base, {}).arch.widths; }

// An InputError's text without the place in a scene or arch that the user did not write: "path:line:column:
// ".
std::string without_place(const std::string& text) {
  const size_t at = text.find(": ");
  const bool placed =
      at != std::string::npos && at > 0 && std::isdigit(static_cast<unsigned char>(text[at - 1]));
  return placed ? text.substr(at + 2) : text;
}

// The same of a hint that names a line there.
std::string without_line(std::string hint) {
  const size_t has = hint.find(" has the key");
  if (has == std::string::npos) return hint;
  const size_t line = hint.rfind("line ", has);
  return line == std::string::npos ? hint : hint.replace(line, has - line, "the value");
}

void try_alone(const ConfigValue& value, const Set& set, const Base& base) {
  Settings settings;
  set(settings);
  try {
    resolve(base, settings);
  } catch (const InputError& error) {
    const ErrorParts parts = parts_of(error);
    value.fail(without_place(parts.message), without_line(parts.hint));
  }
}

std::string label_of(const ConfigValue& value) {
  return value.is_string() ? value.string() : toml_text(value);
}

// One brick is a list of its own.
std::vector<ConfigValue> notches(const ConfigValue& value, bool of_lists = false) {
  std::vector<ConfigValue> items = value.is_array() ? value.items() : std::vector{value};
  if (of_lists && !items.empty() && !items[0].is_array()) items = {value};
  if (items.empty()) value.fail(fmt::format("'{}' lists nothing", value.key()));
  return items;
}

Axis axis_of(const Key& key, const ConfigValue& value, const Base& base, const Widths& widths) {
  Axis axis{key.name, {}, {}};
  for (const ConfigValue& item : notches(value, std::string(key.name) == "brick")) {
    axis.labels.push_back(label_of(item));
    axis.sets.push_back(set_of(key, item, widths));
    if (key.alone && key.target) try_alone(item, axis.sets.back(), base);
  }
  return axis;
}

const char* name_of(KeysOf keys) { return keys == KeysOf::errors ? "sweep" : "machines"; }

// Each preset sets what it names.
Axis read_presets(const ConfigValue& value, const Base& base, const Widths& widths, KeysOf keys) {
  Axis axis{"presets", {}, {}};
  for (const ConfigValue& item : notches(value)) {
    const ConfigTable preset = item.table();
    preset.record_as(name_of(keys));
    axis.labels.push_back(preset.at("name").string());
    std::vector<Set> sets;
    for (const Key& key : kKeys)
      if (const auto found = key.is_of(keys) ? preset.find(key.name) : std::nullopt)
        sets.push_back(set_of(key, *found, widths));
    axis.sets.push_back([sets](Settings& settings) {
      for (const Set& set : sets) set(settings);
    });
    preset.done();
    try_alone(item, axis.sets.back(), base);
  }
  return axis;
}

void add_leaves(const ConfigTable& table, const std::string& prefix, std::vector<Leaf>& out) {
  for (const std::string& name : table.names()) {
    const ConfigValue value = table.at(name);
    if (value.is_table())
      add_leaves(value.table(), prefix + name + ".", out);
    else
      out.push_back({prefix + name, value});
  }
}

}  // namespace

std::string toml_text(const ConfigValue& value) {
  if (value.is_string()) return toml_string(value.string());
  if (value.is_number()) return fmt::format("{}", value.number(quantity::number));
  if (!value.is_array()) return value.boolean() ? "true" : "false";
  std::string text;
  for (const ConfigValue& item : value.items()) text += (text.empty() ? "" : ", ") + toml_text(item);
  return "[" + text + "]";
}

std::vector<Leaf> leaves(const ConfigTable& table) {
  std::vector<Leaf> out;
  add_leaves(table, "", out);
  return out;
}

std::vector<Axis> read_axes(const ConfigTable& table, const Base& base, KeysOf keys) {
  std::vector<Axis> axes;
  const Widths widths = widths_of(base);
  table.record_as(name_of(keys));  // its keys have one place in the documentation
  for (const Key& key : kKeys)
    if (const auto value = key.is_of(keys) ? table.find(key.name) : std::nullopt)
      axes.push_back(axis_of(key, *value, base, widths));
  if (const auto presets = table.find("presets")) axes.push_back(read_presets(*presets, base, widths, keys));
  if (const auto set = table.table_at("set"))
    for (const Leaf& leaf : leaves(*set)) {
      Axis axis{leaf.key, {}, {}};
      for (const ConfigValue& item : notches(leaf.value)) {
        axis.labels.push_back(label_of(item));
        axis.sets.push_back(change_of(leaf.key, toml_text(item)));
        try_alone(item, axis.sets.back(), base);
      }
      axes.push_back(std::move(axis));
    }
  table.done();
  return axes;
}

}  // namespace cuboct::study
