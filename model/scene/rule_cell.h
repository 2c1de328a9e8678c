// SPDX-License-Identifier: MIT
// What a rule that is text must be for a cell of its matter, at rest, that repeats.
#pragma once

#include <string>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

// InputError where the rule has rounds, but no cell of it can be at rest, repeat and be strained: it is no
// text, keeps fields from step to step, draws noise or asks where a particle is.
void refuse_cell(const Rule& rule);
// Of such a rule the fields whose starts ask where a particle is.
std::vector<std::string> starts_by_place(const Rule& rule);
// How many reaches away a particle may stand of which a force knows: what it reads was made by so many
// rounds, each of neighbours. 1 of pairs.
double reaches_of(const Rule& rule);

}  // namespace cuboct
