// SPDX-License-Identifier: MIT
// Files that come with this code, which is a program or a module of another one: libraries that are loaded by
// those who ask for them, and programs for one task of ours.
#pragma once

#include <string>
#include <vector>

namespace cuboct {

// The path of such a file: where look_for_parts_in() says, in program_directory() or in ../lib of it. Empty
// where there is none.
std::string part_path(const std::string& name);

// The address of `symbol` in the library `name`, by part_path(); null where there is none. It stays loaded:
// what it makes may live as long as the program. InputError where the file does not load or lacks the symbol.
void* module_symbol(const std::string& name, const char* symbol);

// Directories to look in first: within a program that is not ours, such as Python, those of our module.
void look_for_parts_in(std::vector<std::string> directories);

}  // namespace cuboct
