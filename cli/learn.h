// SPDX-License-Identifier: MIT
// `cuboct learn STUDY`: a peridynamic solid from atoms.
#pragma once

namespace CLI {
class App;
}

namespace cuboct {

void add_learn(CLI::App& app, int& exit_code);

}  // namespace cuboct
