// SPDX-License-Identifier: MIT
// A rule as its author wrote it: parsed, not yet understood. docs/user/rules.md.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/program/formula.h"
#include "model/program/potential_file.h"
#include "model/rules/declaration.h"

namespace cuboct {

struct RuleText {
  struct Parameter {
    double value = 0;  // SI
    Dimension dimension;
    std::string text;  // as it was written
  };
  // A field of particles or of bonds.
  struct Field {
    std::string name;
    Value::Kind kind = Value::Kind::number;
    Dimension dimension;
    std::string unit;  // of its SI values; empty: a plain number
    std::string what;
    bool shown = true;                               // of particles: in frames
    std::optional<std::pair<double, double>> range;  // SI, least and greatest, which integers need
    double resolution = 0;                           // SI, of integers at most; 0: as fine as they are
    std::optional<Formula> start;                    // else 0, or false
    std::function<void(const std::string& message, const std::string& hint)> fail;
  };
  struct Sum {
    std::string name;
    Formula is;
    std::optional<Formula> when;
  };
  struct Write {
    std::string name;
    Formula is;
  };
  struct Round {
    std::string name;
    std::vector<Sum> sums;
    std::vector<Write> bonds, finishes;
    std::function<void(const std::string& message, const std::string& hint)> fail;
  };

  // A function of one number, by values.
  struct Table {
    std::string name;
    std::vector<Formula> at, value, slope;  // of constants; no slope: those of monotone_slopes()
    std::function<void(const std::string& message, const std::string& hint)> fail;
  };

  std::string name;
  bool units = true;  // false: all quantities are plain numbers
  BondRange range = BondRange::current;
  bool still = false;  // no particle moves
  std::map<std::string, Parameter> parameters;
  std::optional<Formula> reach;  // m; always there
  std::optional<Formula> core;   // m; there: the rule is a pair law
  std::optional<Formula> stiffness, pair_energy, particle_energy, broken;
  std::vector<Field> particle, bond;
  std::map<std::string, Formula> lets;
  std::vector<Table> tables;
  std::vector<Round> setup, rounds;
  std::shared_ptr<const EmbeddedAtoms> potential;  // null: the rule has none
};

// Of what the rule does: of names, numbers and formulas, not of comments.
uint64_t hash_of(const RuleText& text);

}  // namespace cuboct
