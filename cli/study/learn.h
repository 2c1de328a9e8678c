// SPDX-License-Identifier: MIT
// `cuboct learn STUDY`: a peridynamic solid from atoms.
#pragma once

namespace cuboct {

class Command;

void add_learn(Command& app, int& exit_code);

}  // namespace cuboct
