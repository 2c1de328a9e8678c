// SPDX-License-Identifier: MIT
// A library that reads a stranger's file may crash, hang or ask for all memory. Such a library runs in a
// program of its own, under limits, and leaves what it read in a file that we read ourselves.
#pragma once

#include <cstdint>
#include <string>

namespace cuboct {

struct ReaderLimits {
  uint64_t seconds = 0;  // of processor time; ten times as many by the clock, for a disk that does not answer
  uint64_t megabytes = 0;  // of address space
};

// What no honest file of these bytes needs.
ReaderLimits reader_limits(uint64_t bytes);

// Runs `program`, a path, as `program FILE RESULT SECONDS MEGABYTES`. InputError, of one line, where it ends
// otherwise than with 0: what it wrote to stderr where it ends with 2, else which limit it met or how it
// ended.
void read_guarded(const std::string& program, const std::string& file, const std::string& result,
                  const ReaderLimits& limits);

// Within such a program, before it opens the file. Nothing is left of a crash.
void take_limits(const ReaderLimits& limits);

}  // namespace cuboct
