// SPDX-License-Identifier: MIT
#include "study/machines/constraint.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "model/base/spelling.h"

namespace cuboct::study {
namespace {

std::string trimmed(const std::string& text) {
  const size_t from = text.find_first_not_of(' '), to = text.find_last_not_of(' ');
  return from == std::string::npos ? "" : text.substr(from, to - from + 1);
}

[[noreturn]] void unknown(const ConfigValue& at, const std::string& what, const std::string& name,
                          const std::vector<std::string>& known) {
  const std::string near = did_you_mean(name, known);
  at.fail(fmt::format("no {} '{}'", what, name), near.empty() ? "known: " + list_of(known) : near);
}

size_t measure_named(const ConfigValue& at, const std::string& name,
                     const std::vector<std::string>& figures) {
  const std::vector<std::string> names = measure_names(figures);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) unknown(at, "quantity", name, names);
  const auto measure = static_cast<size_t>(found - names.begin());
  if (quantity_at(measure) == MachineQuantity::error && figures.empty())
    at.fail("the study has no figure whose error could be held", "add a [[figure]]");
  return measure;
}

// "10 W", "1e-3", "1%".
double limit_of(const ConfigValue& at, std::string text, MachineQuantity quantity) {
  const QuantityName& name = named(quantity);
  const std::string example =
      fmt::format("{} <= {}", name.name, *name.unit ? std::string("2 ") + name.unit : "2");
  bool percent = false;
  if (text.ends_with("%") && quantity == MachineQuantity::error) {
    percent = true;
    text = trimmed(text.substr(0, text.size() - 1));
  }
  ParsedQuantity parsed;
  try {
    parsed = parse_quantity(text);
  } catch (const UnitError& error) {
    at.fail(fmt::format("the limit '{}' of '{}': {}", text, name.name, error.message),
            error.hint.empty() ? "such as \"" + example + "\"" : error.hint);
  }
  if (parsed.list || parsed.dimension != name.dimension)
    at.fail(fmt::format("the limit '{}' of '{}' is {}, not {}", text, name.name,
                        parsed.list ? "a list" : describe(parsed.dimension), describe(name.dimension)),
            "such as \"" + example + "\"");
  const double limit = parsed.values[0] * (percent ? 0.01 : 1);
  if (!(limit > 0)) at.fail(fmt::format("the limit '{}' of '{}' is not above 0", text, name.name));
  return limit;
}

MachineConstraint parse(const ConfigValue& at, const std::vector<std::string>& figures,
                        const std::vector<std::string>& targets) {
  MachineConstraint constraint;
  constraint.text = trimmed(at.string());
  const std::string& text = constraint.text;
  if (text.starts_with("fits ")) {
    constraint.target = trimmed(text.substr(5));
    if (std::ranges::find(targets, constraint.target) == targets.end())
      unknown(at, "device", constraint.target, targets);
    constraint.limit = 1;  // of the share of its room
    return constraint;
  }
  const size_t op = text.find_first_of("<>");
  if (op == std::string::npos || op + 1 >= text.size() || text[op + 1] != '=')
    at.fail(fmt::format("'{}' is no constraint", text),
            "a quantity, <= or >=, a limit, as \"power <= 10 W\"; or \"fits ecp5-85\"");
  constraint.measure = measure_named(at, trimmed(text.substr(0, op)), figures);
  constraint.at_most = text[op] == '<';
  constraint.limit = limit_of(at, trimmed(text.substr(op + 2)), quantity_at(constraint.measure));
  return constraint;
}

// One that no value keeps together with `other`.
bool contradicts(const MachineConstraint& a, const MachineConstraint& b) {
  if (!a.target.empty() || !b.target.empty())
    return !a.target.empty() && !b.target.empty() && a.target != b.target;
  if (a.measure != b.measure || a.at_most == b.at_most) return false;
  const MachineConstraint &most = a.at_most ? a : b, &least = a.at_most ? b : a;
  return least.limit > most.limit;
}

}  // namespace

const char* to_string(Verdict verdict) {
  static constexpr const char* kWords[] = {"holds", "undecided", "fails"};
  return kWords[static_cast<size_t>(verdict)];
}

std::vector<MachineConstraint> read_constraints(const ConfigTable& root,
                                                const std::vector<std::string>& figures,
                                                const std::vector<std::string>& targets) {
  std::vector<MachineConstraint> constraints;
  const auto list = root.find("constraints");
  if (!list) return constraints;
  for (const ConfigValue& at : list->items()) {
    const MachineConstraint constraint = parse(at, figures, targets);
    for (const MachineConstraint& before : constraints)
      if (contradicts(before, constraint))
        at.fail(fmt::format("no machine keeps both '{}' and '{}'", before.text, constraint.text));
    constraints.push_back(constraint);
  }
  return constraints;
}

Verdict judge(const MachineConstraint& constraint, const MachineValue& value) {
  if (!value.there()) return Verdict::undecided;
  const auto [low, high] = value.band;
  if (constraint.at_most) {
    if (low > constraint.limit) return Verdict::fails;
    return high <= constraint.limit && !value.open ? Verdict::holds : Verdict::undecided;
  }
  if (low >= constraint.limit) return Verdict::holds;
  return high < constraint.limit && !value.open ? Verdict::fails : Verdict::undecided;
}

double excess(const MachineConstraint& constraint, const MachineValue& value) {
  if (!value.there()) return std::numeric_limits<double>::infinity();
  return constraint.at_most ? value.band.high / constraint.limit : constraint.limit / value.band.low;
}

std::vector<size_t> read_objectives(const ConfigTable& root, const std::vector<std::string>& figures) {
  std::vector<size_t> objectives;
  const auto list = root.find("minimise");
  if (!list)
    return {static_cast<size_t>(MachineQuantity::time), static_cast<size_t>(MachineQuantity::energy)};
  for (const ConfigValue& at : list->items()) {
    const size_t measure = measure_named(at, at.string(), figures);
    const QuantityName& name = named(quantity_at(measure));
    if (name.more_is_better) at.fail(fmt::format("less of '{}' is no aim", name.name), "minimise \"time\"");
    if (std::ranges::find(objectives, measure) != objectives.end())
      at.fail(fmt::format("'{}' stands twice", name.name));
    objectives.push_back(measure);
  }
  if (objectives.empty()) list->fail("'minimise' lists nothing");
  return objectives;
}

}  // namespace cuboct::study
