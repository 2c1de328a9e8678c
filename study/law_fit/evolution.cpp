// SPDX-License-Identifier: MIT
#include "study/law_fit/evolution.h"

#include <string>

#include "model/base/error.h"
#include "model/base/module.h"

namespace cuboct::fit {
namespace {

MakeGenerations* find_maker() {
  if (void* maker = module_symbol(kEvolutionModule, kMakeGenerations))
    return reinterpret_cast<MakeGenerations*>(maker);
  throw InputError(std::string("no module ") + kEvolutionModule + ", which 'cuboct fit' needs",
                   "it is built beside cuboct; an installation has none");
}

}  // namespace

Evolution::Evolution(const std::vector<double>& start, double start_loss, unsigned samples, double spread,
                     unsigned seed)
    : generations_(find_maker()(start, start_loss, samples, spread, seed)) {}

}  // namespace cuboct::fit
