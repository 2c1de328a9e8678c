// SPDX-License-Identifier: MIT
// What asks for far more than this machine has gets a word first, and needs a yes: --anyway.
// docs/reference/failures.md lists all such bounds.
#pragma once

#include <string>

namespace cuboct {

class Command;

// How a refusal's hint ends.
inline constexpr const char* kAnyway = "; --anyway runs it all the same";

void add_anyway_to(Command& command, bool& anyway);

// Threads, processes or jobs that do no harm here. Some more than cores show that no bit depends on them.
int most_workers();

// "this machine has 2 cores to use"
std::string cores_text();

// Throws InputError where `count`, of the option "--threads" or "--jobs", is more than that. 0: not given.
void check_workers(const std::string& option, int count, bool anyway);

// What takes longer is refused, s: estimates of time are right within a factor of 3 or so.
inline constexpr double kMostSeconds = 30 * 86400.0;

// "3.2 years", of a time that is longer.
std::string long_time(double seconds);

// Throws InputError where `what`, as "--steps 100", takes about so many seconds. `less`: what would do.
void check_time(const std::string& what, double seconds, const std::string& less, bool anyway);

// The same of bytes of memory beside what is free.
void check_memory(const std::string& what, double bytes, const std::string& less, bool anyway);

}  // namespace cuboct
