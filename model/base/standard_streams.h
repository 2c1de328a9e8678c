// SPDX-License-Identifier: MIT
// Standard input, output and error as every program of this project has them.
#pragma once

#include <functional>
#include <string>

namespace cuboct {

// Descriptors 0 to 2 that the caller left closed become /dev/null. A file that is opened later would take
// such a number, and would be overwritten by what is printed.
void fill_standard_descriptors();

// What a program's main does first, and all that it does: `work`, whose exit code it returns as exit_code_of.
// Descriptors are filled. A write beyond the limit of file sizes fails, as one on a full disk does.
//
// What is printed and cannot be written never stops the work. At the end a full standard output is told by
// `tell` (by default: to standard error), and exit code 0 becomes 1. A reader of it that has left, as `head`
// does, is no error: the exit code stays the work's. What does not fit into standard error is dropped.
int with_standard_streams(const std::function<int()>& work,
                          const std::function<void(const std::string& text)>& tell = {});

// What `work` returns; 1, and a line of what it was, where an exception leaves it. For work that a library
// calls which would tell of it in words of its own.
int exit_code_of(const std::function<int()>& work);

// Whether nothing printed from now on reaches anybody: work that has no other result may end.
bool output_is_lost();

}  // namespace cuboct
