// SPDX-License-Identifier: MIT
// What --help prints: at most 80 columns; of each command what it does, its words, its options and an
// example.
#pragma once

namespace CLI {
class App;
}

namespace cuboct {

// To be called once all commands are there: puts them in groups, and gives each its example.
void set_help(CLI::App& app);

}  // namespace cuboct
