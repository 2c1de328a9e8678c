// SPDX-License-Identifier: MIT
#include "study/law_fit/target.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "model/base/spelling.h"
#include "model/base/text.h"
#include "study/law_fit/csv.h"
#include "study/law_fit/curve_error.h"

namespace cuboct::fit {
namespace {

constexpr size_t kEven = 201;
constexpr double kElasticStrain = 0.005;
// A stress at strain 0, over the strength, that counts as none.
constexpr double kStressAtRest = 0.01;
// Beyond every matter.
constexpr double kMostStress = 1e18, kMostStrain = 100;

// Who tells an error of point k, at its place.
using Fail = std::function<void(size_t k, const std::string& message, const std::string& hint)>;

void check(Target& target, const Fail& fail) {
  const auto [strain, stress] = std::tie(target.strain, target.stress);
  for (size_t k = 0; k < strain.size(); ++k)
    if (!(std::abs(stress[k]) <= kMostStress) || !(std::abs(strain[k]) <= kMostStrain))
      fail(k,
           fmt::format("a stress of {:g} Pa at a strain of {:g}: at most {:g} Pa and {:g} are taken",
                       stress[k], strain[k], kMostStress, kMostStrain),
           "the right units of the columns");
  for (size_t k = 1; k < strain.size(); ++k)
    if (!(strain[k] > strain[k - 1]))
      fail(k, fmt::format("strains must ascend, but {:g} follows {:g}", strain[k], strain[k - 1]),
           "a curve that goes back is no function of strain: leave the unloading out");
  if (strain.size() < 3) fail(0, fmt::format("{} points, but at least 3 are needed", strain.size()), "");
  if (strain[0] < 0) fail(0, fmt::format("the first strain is {:g}, below 0", strain[0]), "");
  target.strength = *std::ranges::max_element(stress);
  if (!(target.strength > 0))
    fail(0, fmt::format("the largest stress is {:g} Pa: this is no curve of tension", target.strength), "");
  if (strain[0] == 0 && std::abs(stress[0]) > kStressAtRest * target.strength)
    fail(0, fmt::format("the stress at strain 0 is {:g} Pa: a body at rest has none", stress[0]),
         "take the stress of the start off, or let strains count from where it is 0");
}

// [target] `to`: the points up to there.
void cut(const ConfigTable& table, Target& target) {
  const auto to = table.find("to");
  if (!to) return;
  const double last = to->number(quantity::number, Range::positive());
  size_t count = 0;
  while (count < target.strain.size() && target.strain[count] <= last) ++count;
  if (count < 3) to->fail(fmt::format("{} points lie up to there, but at least 3 are needed", count));
  target.strain.resize(count), target.stress.resize(count);
}

void measure(Target& target, const Fail& fail) {
  if (target.strain[0] > 0) {
    target.strain.insert(target.strain.begin(), 0.0);
    target.stress.insert(target.stress.begin(), 0.0);
  }
  target.even_strain = even_strains(target.strain.back(), kEven);
  target.even_stress = first_passage(target.strain, target.stress, target.even_strain);
  target.yield_strain =
      target.strain[static_cast<size_t>(std::ranges::max_element(target.stress) - target.stress.begin())];
  double xy = 0, xx = 0;
  for (size_t k = 1; k < target.strain.size() && (k == 1 || target.strain[k] <= kElasticStrain); ++k) {
    xy += target.strain[k] * target.stress[k];
    xx += target.strain[k] * target.strain[k];
  }
  target.modulus = xy / xx;
  if (!(target.modulus > 0))
    fail(0,
         fmt::format("the curve begins with a slope of {:g} Pa: no law has a modulus that is not above 0",
                     target.modulus),
         "");
}

// What the header says, where it says it in words that are known.
std::optional<double> unit_of(const CsvColumn& column, const Quantity& quantity) {
  if (quantity.dimension == quantity::number.dimension) {
    if (column.unit == "%") return 0.01;
    return column.unit == "1" || column.unit == "-" ? std::optional(1.0) : std::nullopt;
  }
  try {
    const ParsedQuantity parsed = parse_quantity("1 " + column.unit);
    if (parsed.dimension == quantity.dimension && parsed.values.size() == 1) return parsed.values[0];
  } catch (const UnitError&) {
  }
  return std::nullopt;
}

// In the unit of its column, or of `key` of the study.
double unit_of(const ConfigTable& table, const Csv& csv, const CsvColumn& column, const std::string& key,
               const Quantity& quantity) {
  const bool number = quantity.dimension == quantity::number.dimension;
  const std::optional<double> said = unit_of(column, quantity);
  if (const auto value = table.find(key)) {
    const double unit = !number ? value->unit(quantity) : value->choice("unit", {"1", "%"}) == 1 ? 0.01 : 1;
    if (said && std::abs(*said / unit - 1) > 1e-12)
      value->fail(
          fmt::format("'{}' is not the unit that line {} of {} states for '{}', '{}'", value->string(),
                      csv.header, line_text(csv.path), line_text(column.name), line_text(column.unit)),
          fmt::format("without '{}' the file's unit holds", key));
    return unit;
  }
  if (said) return *said;
  if (column.unit.empty() && (number || table.reduced())) return 1;
  if (column.unit.empty())
    csv.fail(csv.header, column.column, fmt::format("the unit of '{}' is missing", column.name),
             fmt::format("write '{} (MPa)', or {} = \"MPa\" in [target]", column.name, key));
  if (number)
    csv.fail(csv.header, column.column, fmt::format("'{}' is no unit of strain", column.unit),
             "strains are in % or have no unit");
  csv.fail(csv.header, column.column, fmt::format("'{}' is no unit of {}", column.unit, quantity.name),
           "e.g. MPa");
}

const CsvColumn& column_of(const ConfigTable& table, const Csv& csv, const std::string& name,
                           const std::string& key) {
  const std::string wanted = table.string_or(key, name);
  std::vector<std::string> names;
  for (const CsvColumn& column : csv.columns) {
    if (column.name == wanted) return column;
    names.push_back(column.name);
  }
  const std::string near = did_you_mean(wanted, names);
  csv.fail(
      csv.header, 1, fmt::format("no column '{}'", wanted),
      !near.empty() ? near : fmt::format("known: {}; {} in [target] names another", list_of(names), key));
}

Target from_file(const ConfigTable& table) {
  const ConfigValue file = table.at("file");
  Target target;
  target.source = file.string();
  const Csv csv = read_csv(file.file());
  if (csv.columns.empty()) file.fail(fmt::format("{} holds no curve", csv.path));
  const CsvColumn& strain = column_of(table, csv, "strain", "strain_column");
  const CsvColumn& stress = column_of(table, csv, "stress", "stress_column");
  const double strain_unit = unit_of(table, csv, strain, "strain_unit", quantity::number);
  const double stress_unit = unit_of(table, csv, stress, "stress_unit", quantity::pressure);
  for (const double value : strain.values) target.strain.push_back(strain_unit * value);
  for (const double value : stress.values) target.stress.push_back(stress_unit * value);
  const Fail fail = [&](size_t k, const std::string& message, const std::string& hint) {
    csv.fail(k < csv.lines.size() ? csv.lines[k] : csv.header, 1, message, hint);
  };
  cut(table, target);
  check(target, fail);
  measure(target, fail);
  return target;
}

Target from_lists(const ConfigTable& table) {
  const ConfigValue strain = table.at("strain"), stress = table.at("stress");
  Target target;
  target.source = "[target]";
  target.strain = strain.numbers(quantity::number);
  target.stress = stress.numbers(quantity::pressure);
  if (target.strain.size() != target.stress.size())
    stress.fail(
        fmt::format("'strain' has {} points, 'stress' has {}", target.strain.size(), target.stress.size()));
  const Fail fail = [&](size_t, const std::string& message, const std::string& hint) {
    strain.fail(message, hint);
  };
  cut(table, target);
  check(target, fail);
  measure(target, fail);
  return target;
}

}  // namespace

Target read_target(const ConfigTable& table) {
  table.not_both("file", "strain");
  return table.has("file") ? from_file(table) : from_lists(table);
}

}  // namespace cuboct::fit
