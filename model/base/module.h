// SPDX-License-Identifier: MIT
// Modules beside the program: what has heavy libraries is loaded by those who ask for it.
#pragma once

#include <string>

namespace cuboct {

// The address of `symbol` in the file `module`, looked for in program_directory() and in ../lib of it; null
// where there is none. A module stays loaded: what it makes may live as long as the program. InputError where
// the file does not load or lacks the symbol.
void* module_symbol(const std::string& module, const char* symbol);

}  // namespace cuboct
