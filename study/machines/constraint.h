// SPDX-License-Identifier: MIT
// What a machine has to keep: "power <= 10 W", "steps/s >= 1e6", "error.modulus <= 1%", "fits ecp5-85".
#pragma once

#include <string>
#include <vector>

#include "model/config/config.h"
#include "study/machines/quantity.h"

namespace cuboct::study {

struct MachineConstraint {
  std::string text;     // as the file has it
  std::string target;   // of "fits": the device; else empty
  size_t measure = 0;   // of measure_names
  bool at_most = true;  // else at least
  double limit = 0;     // SI
};

// The list `constraints` of a study; none where the key is absent. Throws InputError at the text that is
// wrong: an unknown quantity, another unit, limits that no value keeps. `targets`: devices that can be named.
std::vector<MachineConstraint> read_constraints(const ConfigTable& root,
                                                const std::vector<std::string>& figures,
                                                const std::vector<std::string>& targets);

// A band keeps a limit only where all of it does, and breaks it only where none of it does. What is not known
// breaks nothing and keeps nothing.
enum class Verdict : uint8_t { holds, undecided, fails };
const char* to_string(Verdict verdict);
Verdict judge(const MachineConstraint& constraint, const MachineValue& value);

// By how much the value's end that a claim needs misses the limit: 1 and below, it holds; 2, half or twice of
// what is asked. Infinite where it is not known.
double excess(const MachineConstraint& constraint, const MachineValue& value);

// "power", "time" of the list `minimise`: places in measure_names. The first is what --best chooses by.
std::vector<size_t> read_objectives(const ConfigTable& root, const std::vector<std::string>& figures);

}  // namespace cuboct::study
