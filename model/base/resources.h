// SPDX-License-Identifier: MIT
// What this machine has for this process.
#pragma once

#include <cstdint>
#include <string>

namespace cuboct {

// Cores that the process may keep busy: those of its affinity, or what its control group's quota pays for. At
// least 1. As they are at the first call.
int usable_cores();

// Bytes that the process can still take without swapping: of the machine's available memory, of its control
// groups' limits and of its address space (RLIMIT_AS), what is least.
uint64_t free_memory();

// "22.6 GB": for people.
std::string in_bytes(double bytes);

// Where cuboct may keep what it can make again: below XDG_CACHE_HOME or HOME; empty where neither is set.
std::string cache_directory();

// Bytes that a user may write where `path`, which need not exist yet, would lie.
uint64_t free_disk(const std::string& path);

}  // namespace cuboct
