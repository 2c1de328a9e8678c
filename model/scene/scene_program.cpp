// SPDX-License-Identifier: MIT
// A rule as text: rule = "heat.toml" of a scene, or its tables within [rule].
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/base/hash.h"
#include "model/config/file_kind.h"
#include "model/contract/material_name.h"
#include "model/program/formula_law.h"
#include "model/program/program_rule.h"
#include "model/scene/scene_parts.h"

namespace cuboct {
namespace {

Formula formula_of(const ConfigValue& value) {
  const auto fail = [value](const FormulaError& error) {
    value.fail_in(error.at, error.message, error.hint);
  };
  if (value.is_number()) {
    Expression number;
    number.value = value.number(quantity::number);
    return {fmt::format("{}", number.value), number,
            [value](const FormulaError& error) { value.fail(error.message, error.hint); }};
  }
  try {
    return {value.string(), parse_expression(value.string()), fail};
  } catch (const FormulaError& error) {
    fail(error);
    throw;
  }
}

std::optional<Formula> formula_at(const ConfigTable& table, const std::string& key) {
  const auto value = table.find(key);
  return value ? std::optional(formula_of(*value)) : std::nullopt;
}

std::function<void(const std::string&, const std::string&)> failing(const ConfigValue& value) {
  return [value](const std::string& message, const std::string& hint) { value.fail(message, hint); };
}

// Of any dimension.
ParsedQuantity quantity_of(const ConfigValue& value, const std::string& text) {
  try {
    const ParsedQuantity q = parse_quantity(text);
    if (q.list) value.fail(fmt::format("'{}' must be one value", value.key()));
    return q;
  } catch (const UnitError& error) {
    value.fail(error.message, error.hint);
  }
}

// A table whose keys are names that the user chose.
std::optional<ConfigTable> names_at(const ConfigTable& table, const std::string& key) {
  const auto names = table.table_at(key);
  if (names) names->record_as("names");
  return names;
}

RuleText::Parameter parameter_of(const ConfigValue& value) {
  if (value.is_number()) {
    const double number = value.number(quantity::number);
    return {number, {}, fmt::format("{}", number)};
  }
  if (value.reduced()) value.fail(fmt::format("'{}' must be a plain number", value.key()));
  const std::string text = value.string();
  const ParsedQuantity q = quantity_of(value, text);
  return {q.values[0], q.dimension, text};
}

// A name of the user's: as formulas take it.
void check_name(const ConfigValue& value) {
  const std::string& name = value.key();
  const Expression e = [&] {
    try {
      return parse_expression(name);
    } catch (const FormulaError&) {
      return Expression{};
    }
  }();
  if (e.kind != Expression::Kind::name || e.text != name)
    value.fail(fmt::format("'{}' is no name", name), "letters, digits and '_'");
  if (name.ends_with("_i") || name.ends_with("_j"))
    value.fail(fmt::format("'{}' ends as a particle's own or other field does", name));
}

double resolution_of(const ConfigValue& value, const RuleText::Field& field) {
  if (field.kind == Value::Kind::truth) value.fail("a truth has no resolution");
  return value.number({field.dimension, "one value", "0.1"}, Range::positive());
}

RuleText::Field field_of(const ConfigTable& table) {
  RuleText::Field field;
  field.name = table.key();
  check_name(table);
  if (const auto kind = table.find("kind"))
    field.kind = static_cast<Value::Kind>(kind->choice("kind", {"number", "vector", "truth"}));
  if (const auto unit = table.find("unit")) {
    if (field.kind == Value::Kind::truth) unit->fail("a truth has no unit");
    if (unit->reduced()) unit->fail("units = \"reduced\": there are none");
    const ParsedQuantity one = quantity_of(*unit, "1 " + unit->string());
    field.dimension = one.dimension;
    field.unit = one.values[0] == 1 ? unit->string() : si_unit(one.dimension);
  }
  if (const auto range = table.find("range")) {
    const std::vector<double> ends = range->numbers({field.dimension, "two values", "[0, 1]"});
    if (ends.size() != 2 || !(ends[0] < ends[1]))
      range->fail("'range' needs the least and the greatest value");
    field.range = {ends[0], ends[1]};
  }
  if (const auto resolution = table.find("resolution")) field.resolution = resolution_of(*resolution, field);
  field.what = table.string_or("what", "");
  field.start = formula_at(table, "start");
  field.fail = failing(table);
  return field;
}

std::vector<RuleText::Field> fields_of(const ConfigTable& table, const std::string& key, bool shown) {
  std::vector<RuleText::Field> fields;
  const auto all = names_at(table, key);
  if (!all) return fields;
  for (const std::string& name : all->names()) {
    const ConfigTable one = all->at(name).table();
    one.record_as("rule");
    fields.push_back(field_of(one));
    if (shown) fields.back().shown = one.boolean_or("shown", true);
  }
  return fields;
}

std::vector<RuleText::Write> writes_of(const ConfigTable& round, const std::string& key) {
  std::vector<RuleText::Write> writes;
  if (const auto table = names_at(round, key))
    for (const std::string& name : table->names()) writes.push_back({name, formula_of(table->at(name))});
  return writes;
}

RuleText::Sum sum_of(const ConfigValue& value) {
  check_name(value);
  if (!value.is_table()) return {value.key(), formula_of(value), {}};
  const ConfigTable table = value.table();
  table.record_as("rule");
  return {value.key(), formula_of(table.at("is")), formula_at(table, "when")};
}

std::vector<RuleText::Round> rounds_in(const ConfigTable& table, const std::string& key) {
  std::vector<RuleText::Round> rounds;
  for (const ConfigTable& one : table.tables(key)) {
    one.record_as("rule");
    RuleText::Round round;
    round.name = one.string_or("name", fmt::format("{} {}", key, rounds.size() + 1));
    if (const auto sums = names_at(one, "sum"))
      for (const std::string& name : sums->names()) round.sums.push_back(sum_of(sums->at(name)));
    round.bonds = writes_of(one, "bond");
    round.finishes = writes_of(one, "finish");
    round.fail = failing(one);
    rounds.push_back(std::move(round));
  }
  return rounds;
}

// A list of formulas, or of quantities in one string.
std::vector<Formula> column_of(const ConfigValue& value) {
  std::vector<Formula> column;
  if (!value.is_string()) {
    for (const ConfigValue& item : value.items()) column.push_back(formula_of(item));
    return column;
  }
  const ParsedQuantity all = [&] {
    try {
      return parse_quantity(value.string());
    } catch (const UnitError& error) {
      value.fail(error.message, error.hint);
    }
  }();
  for (const double number : all.values) {
    Expression constant;
    constant.value = number;
    constant.dimension = all.dimension;
    column.push_back({fmt::format("{}", number), constant,
                      [value](const FormulaError& error) { value.fail(error.message, error.hint); }});
  }
  return column;
}

RuleText::Table table_of(const ConfigTable& table) {
  RuleText::Table of{
      table.key(), column_of(table.at("at")), column_of(table.at("value")), {}, failing(table)};
  check_name(table);
  if (const auto slope = table.find("slope")) of.slope = column_of(*slope);
  if (of.at.size() < 2) table.at("at").fail("a table needs two points at least");
  for (const char* key : {"value", "slope"}) {
    const auto& column = key == std::string("value") ? of.value : of.slope;
    if (table.has(key) && column.size() != of.at.size())
      table.at(key).fail(fmt::format("'at' has {} points, '{}' has {}", of.at.size(), key, column.size()));
  }
  return of;
}

void read_values(const ConfigTable& table, RuleText& text) {
  if (const auto tables = names_at(table, "table"))
    for (const std::string& name : tables->names()) {
      const ConfigTable one = tables->at(name).table();
      one.record_as("table");
      text.tables.push_back(table_of(one));
    }

  if (const auto parameters = names_at(table, "parameters"))
    for (const std::string& name : parameters->names()) {
      const ConfigValue value = parameters->at(name);
      check_name(value);
      text.parameters[name] = parameter_of(value);
    }
  if (const auto lets = names_at(table, "let"))
    for (const std::string& name : lets->names()) {
      check_name(lets->at(name));
      text.lets.emplace(name, formula_of(lets->at(name)));
    }
  if (const auto energy = table.table_at("energy")) {
    energy->record_as("rule");
    text.pair_energy = formula_at(*energy, "pair");
    text.particle_energy = formula_at(*energy, "particle");
  }
}

RuleText rule_text(const ConfigTable& table) {
  RuleText text;
  text.units = !table.reduced();
  text.name = table.string_or("name", "own");
  if (const auto bonds = table.find("bonds"))
    text.range =
        bonds->choice("bonds", {"current", "reference"}) == 0 ? BondRange::current : BondRange::reference;
  text.still = table.boolean_or("still", false);
  text.reach = formula_of(table.at("reach"));
  text.core = formula_at(table, "core");
  text.stiffness = formula_at(table, "stiffness");
  text.broken = formula_at(table, "broken");
  read_values(table, text);
  text.particle = fields_of(table, "particle", true);
  text.bond = fields_of(table, "bond", false);
  if (!text.bond.empty() && text.range == BondRange::current)
    table.at("bond").fail("bonds of the moment hold nothing", "bonds = \"reference\"");
  text.setup = rounds_in(table, "setup");
  text.rounds = rounds_in(table, "round");
  if (text.rounds.empty()) table.fail("a rule needs a [[round]]");
  return text;
}

// The file of a rule's tables, and which of its elements particles are. The scene's own keys take the place
// of the rule's.
struct PotentialKeys {
  std::optional<ConfigTable> table;  // where they stand
  std::optional<ConfigValue> file, element;
  std::vector<std::pair<std::string, std::string>> elements;  // by material

  void read(const ConfigTable& rule) {
    const auto keys = rule.table_at("potential");
    if (!keys) return;
    keys->record_as("potential");
    table = keys;
    if (const auto own = keys->find("file")) file = own;
    keys->not_both("element", "elements");
    if (const auto own = keys->find("element")) element = own, elements.clear();
    if (const auto own = names_at(*keys, "elements")) {
      element.reset(), elements.clear();
      for (const std::string& name : own->names()) elements.emplace_back(name, own->at(name).string());
    }
  }
  std::vector<std::string> wanted() const {
    if (element) return {element->string()};
    std::vector<std::string> all;
    for (const auto& [material, name] : elements)
      if (std::ranges::count(all, name) == 0) all.push_back(name);
    return all;
  }
  std::shared_ptr<const EmbeddedAtoms> tables() const {
    if (!table) return nullptr;
    if (!file)
      table->fail("a potential needs its 'file'", "of the scene: [rule] potential.file = \"Cu.eam\"");
    const std::string path = file->file();
    try {
      return std::make_shared<const EmbeddedAtoms>(read_embedded_atoms(path, wanted(), !table->reduced()));
    } catch (const InputError& error) {
      if (error.keys() != std::vector<std::string>{"element"}) throw;
      const ErrorParts parts = parts_of(error);
      (element ? *element : *file).fail(parts.message, parts.hint);
    }
  }
  std::string told() const {
    std::string text;
    for (const auto& [material, name] : elements)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", material, name);
    return text;
  }
  // By type of particles: 2^k of the k-th element.
  std::vector<double> codes(const Scene& scene) const {
    std::vector<double> all;
    if (elements.empty()) return all;
    const std::vector<std::string> names = wanted();
    for (const ParticleType& type : scene.rule.types) {
      const std::string material = material_of(type.name);
      const auto at = std::ranges::find(elements, material, &std::pair<std::string, std::string>::first);
      if (at == elements.end())
        table->fail(fmt::format("'elements' does not say which one the material '{}' is", material));
      const auto k = std::ranges::find(names, at->second) - names.begin();
      all.push_back(std::ldexp(1.0, static_cast<int>(k)));
    }
    return all;
  }
};

// The scene's own values of the file's parameters.
void set_parameters(const ConfigTable& rule, RuleText& text) {
  const auto own = names_at(rule, "parameters");
  if (!own) return;
  for (const std::string& name : own->names()) {
    const ConfigValue value = own->at(name);
    const auto at = text.parameters.find(name);
    if (at == text.parameters.end()) value.fail(fmt::format("the rule has no parameter '{}'", name));
    const RuleText::Parameter set = parameter_of(value);
    if (set.dimension != at->second.dimension)
      value.fail(fmt::format("'{}' must be {}, not {}", name, describe(at->second.dimension),
                             describe(set.dimension)));
    at->second = set;
  }
}

// What the scene's own table `key` says of the file's fields.
void set_fields(const ConfigTable& rule, const std::string& key, RuleText& text,
                const std::function<void(RuleText::Field& field, const ConfigValue& value)>& set) {
  const auto own = names_at(rule, key);
  if (!own) return;
  for (const std::string& name : own->names()) {
    const auto named = [&](std::vector<RuleText::Field>& fields) {
      const auto at = std::ranges::find(fields, name, &RuleText::Field::name);
      return at == fields.end() ? nullptr : &*at;
    };
    RuleText::Field* of = named(text.particle);
    if (of == nullptr) of = named(text.bond);
    if (of == nullptr) own->at(name).fail(fmt::format("the rule has no field '{}'", name));
    set(*of, own->at(name));
  }
}

// The scene's own meaning of the file's names.
void set_lets(const ConfigTable& rule, RuleText& text) {
  const auto own = names_at(rule, "let");
  if (!own) return;
  for (const std::string& name : own->names()) {
    const auto at = text.lets.find(name);
    if (at == text.lets.end()) own->at(name).fail(fmt::format("the rule has no [let] name '{}'", name));
    at->second = formula_of(own->at(name));
  }
}

RuleText text_of_file(const ConfigValue& file, PotentialKeys& potential) {
  const std::string path = file.file(), text = read_config_text(path);
  return read_kind(FileKind::rule, text, path, [&](const ConfigTable& root) {
    if (root.reduced() != file.reduced())
      file.fail(fmt::format("the rule has units = \"{}\", and the scene has not",
                            root.reduced() ? "reduced" : "SI"));
    root.record_as("rule");
    RuleText rule = rule_text(root);
    potential.read(root);
    root.done();
    return rule;
  });
}

// The regions that starts name, as shapes: a start is worked out for the places that a body has as packed.
void place_regions(const Regions& regions, const Scene& scene, RuleProgram& program) {
  const double tolerance = 1e-6 * program.reach;
  program.regions.resize(regions.names().size());
  for (const uint32_t k : regions_of_starts(program)) {
    Hash hash;
    const std::vector<uint32_t> ids = regions.select(k, scene.packing().x, tolerance);
    for (const uint32_t id : ids) hash.add(id);
    program.settings.push_back({"region " + regions.names()[k],
                                fmt::format("{} particles ({:016x})", ids.size(), hash.value()),
                                "named by starts"});
    program.regions[k] = [shape = regions.shape(k), tolerance](const Vec3& x) {
      return shape->distance(x) <= tolerance;
    };
  }
}

RuleChoice chosen(const RuleText& text, const PotentialKeys& potential, const ProgramPlace& place,
                  std::vector<Slit> slits) {
  RuleProgram program = understood(text, place);
  program.slits = std::move(slits);
  for (const Slit& slit : program.slits) program.settings.push_back({"slit", slit.told(), ""});
  if (text.core)
    return {program.reach, nullptr, formula_law(text, std::make_shared<const RuleProgram>(program))};
  return {program.reach,
          [program, potential](const ConfigTable& root, const Regions& regions, const Scene& scene) {
            check_rounds_body(root, scene);
            RuleProgram whole = program;
            place_regions(regions, scene, whole);
            whole.element = potential.codes(scene);
            if (!whole.element.empty())
              whole.settings.push_back({"elements", potential.told(), "by material"});
            return std::make_shared<const ProgramRule>(std::move(whole));
          },
          nullptr};
}

}  // namespace

RuleChoice read_program_rule(const ConfigValue& rule, const PackingChoice* packing,
                             const std::vector<std::string>& regions, const std::function<void()>& no_law) {
  PotentialKeys potential;
  const ProgramPlace place{.pitch = packing != nullptr ? packing->fcc.pitch : 0, .regions = regions};
  const auto with_tables = [&](RuleText text, std::vector<Slit> slits = {}) {
    text.potential = potential.tables();
    return chosen(text, potential, place, std::move(slits));
  };
  const auto placed = [&](RuleText text, const ConfigTable& table) {
    if (!text.core) no_law();
    std::vector<Slit> slits = text.core ? std::vector<Slit>() : read_slits(table);
    if (!slits.empty() && text.range == BondRange::current)
      table.at("slit").fail("bonds of the moment know no slit", "bonds = \"reference\"");
    table.done();
    return with_tables(std::move(text), std::move(slits));
  };
  if (!rule.is_table()) {
    RuleText text = text_of_file(rule, potential);
    if (!text.core) no_law();
    return with_tables(std::move(text));
  }
  const ConfigTable table = rule.table();
  if (const auto file = table.find("file")) {
    RuleText text = text_of_file(*file, potential);
    potential.read(table);
    set_parameters(table, text);
    set_fields(table, "start", text,
               [](RuleText::Field& field, const ConfigValue& value) { field.start = formula_of(value); });
    set_fields(table, "resolution", text, [](RuleText::Field& field, const ConfigValue& value) {
      field.resolution = resolution_of(value, field);
    });
    set_lets(table, text);
    return placed(std::move(text), table);
  }
  RuleText text = rule_text(table);
  potential.read(table);
  return placed(std::move(text), table);
}

}  // namespace cuboct
