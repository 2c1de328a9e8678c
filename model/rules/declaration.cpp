// SPDX-License-Identifier: MIT
#include "model/rules/declaration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <stdexcept>

namespace cuboct {
namespace {

[[noreturn]] void refuse(const RuleDeclaration& rule, const std::string& what) {
  throw std::logic_error(fmt::format("rule '{}': {}", rule.name, what));
}

bool has(const std::vector<RuleField>& fields, const std::string& name) {
  return std::ranges::any_of(fields, [&](const RuleField& field) { return field.name == name; });
}

void check_fields(const RuleDeclaration& rule, const std::vector<RuleField>& fields,
                  std::set<std::string>& names) {
  for (const RuleField& field : fields) {
    if (!names.insert(field.name).second) refuse(rule, fmt::format("two fields '{}'", field.name));
    if (field.numbers < 1) refuse(rule, fmt::format("field '{}' holds nothing", field.name));
  }
}

void check_round(const RuleDeclaration& rule, const RuleRound& round, std::set<std::string>& known) {
  for (const std::string& name : round.exchanged)
    if (!known.count(name))
      refuse(rule, fmt::format("round '{}' exchanges '{}' before it is made", round.name, name));
  for (const std::string& name : round.updated)
    if (!has(rule.bond, name))
      refuse(rule, fmt::format("round '{}' updates '{}', which no bond holds", round.name, name));
  for (const std::string& name : round.made) {
    if (!has(rule.particle, name))
      refuse(rule, fmt::format("round '{}' makes '{}', which no particle holds", round.name, name));
    known.insert(name);
  }
}

std::vector<std::string> texts(const std::vector<RuleField>& fields) {
  std::vector<std::string> out;
  for (const RuleField& field : fields)
    out.push_back(fmt::format("{} ({}{})", field.name, field.numbers, field.of_bonds ? " a bond" : ""));
  return out;
}

std::string list(const std::vector<std::string>& names) {
  return names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

void check(const RuleDeclaration& rule) {
  std::set<std::string> names{"position", "velocity", "id"};
  check_fields(rule, rule.particle, names);
  check_fields(rule, rule.bond, names);
  check_fields(rule, rule.constants, names);
  std::set<std::string> shown;
  check_fields(rule, rule.shown, shown);
  if (rule.rounds.empty()) refuse(rule, "it has no round");
  if (rule.bonds == BondRange::current && !(rule.bond.empty() && rule.constants.empty()))
    refuse(rule, "its bonds are those of the moment, and hold nothing");
  std::set<std::string> known{"position", "velocity", "id"};
  for (const std::string& name : rule.ready) {
    if (!has(rule.particle, name)) refuse(rule, fmt::format("no particle holds '{}'", name));
    known.insert(name);
  }
  for (const RuleRound& round : rule.rounds) {
    check_fields(rule, round.sums, names);
    check_round(rule, round, known);
  }
  for (const RuleField& field : rule.particle)
    if (!known.count(field.name)) refuse(rule, fmt::format("no round makes '{}'", field.name));
  if (rule.moves && std::ranges::count(rule.rounds.back().made, kForceField) != 1)
    refuse(rule, "its last round makes no 'force'");
}

int numbers_of(const std::vector<RuleField>& fields, bool of_bonds) {
  int sum = 0;
  for (const RuleField& field : fields)
    if (field.of_bonds == of_bonds) sum += field.numbers;
  return sum;
}

size_t place_of(const std::vector<RuleField>& fields, const std::string& name) {
  const auto at = std::ranges::find(fields, name, &RuleField::name);
  if (at == fields.end()) throw std::logic_error(fmt::format("no field '{}'", name));
  return static_cast<size_t>(at - fields.begin());
}

std::vector<DeclarationLine> lines_of(const RuleDeclaration& rule) {
  std::vector<DeclarationLine> lines;
  lines.push_back({"rule", rule.name,
                   rule.bonds == BondRange::reference ? "bonds of the body as packed"
                                                      : "bonds between those that are near now"});
  if (rule.noise) lines.push_back({"noise", "drawn anew in each step", "a hash of ids and step"});
  const auto fields = [&](const char* name, const std::vector<RuleField>& of) {
    if (of.empty()) return;
    const int bonds = numbers_of(of, true);
    lines.push_back({name, list(texts(of)),
                     fmt::format("{} numbers each{}", numbers_of(of),
                                 bonds == 0 ? "" : fmt::format(", and {} a bond", bonds))});
  };
  fields("particle fields", rule.particle);
  fields("bond constants", rule.constants);
  fields("bond fields", rule.bond);
  fields("in frames", rule.shown);
  for (size_t k = 0; k < rule.rounds.size(); ++k) {
    const RuleRound& round = rule.rounds[k];
    std::string note = fmt::format("exchanges {}", list(round.exchanged));
    if (!round.updated.empty()) note += fmt::format("; updates {} of bonds", list(round.updated));
    lines.push_back({fmt::format("round {}: {}", k + 1, round.name),
                     fmt::format("sums {}; makes {}", list(texts(round.sums)), list(round.made)), note});
  }
  return lines;
}

}  // namespace cuboct
