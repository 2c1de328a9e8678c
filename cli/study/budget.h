// SPDX-License-Identifier: MIT
// `cuboct explore STUDY --error E`: the cheapest settings within an error budget.
#pragma once

#include <string>

#include "cli/answer.h"
#include "study/sweep/study.h"
#include "study/sweep/truth.h"

namespace cuboct {

struct BudgetOptions {
  std::string error;   // as typed: "1%", "0.01"
  std::string figure;  // its name; empty: the study's only one
  std::string out;     // DIR: search.db, cheapest.toml, cheapest_arch.toml
  int jobs = 0;        // runs at once; 0: one per core
};

// "1%" or "0.01": above 0 and below 1. Throws InputError.
double read_error_budget(const std::string& text);

// Throws InputError where the study has no such figure, or several and none is named.
size_t figure_named(const study::Study& study, const std::string& name);

// What of a question can be told before anything is computed. Throws InputError.
void check_budget(const study::Study& study, const std::string& error, const std::string& figure);

// Prints what was chosen and writes it to DIR. The exit code: 0, or 1 where no settings keep the budget.
int run_budget(const study::Study& study, const study::Truth& truth, const BudgetOptions& options,
               const Answer& answer);

}  // namespace cuboct
