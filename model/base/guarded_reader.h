// SPDX-License-Identifier: MIT
// A library that reads a stranger's file may crash, hang or ask for all memory. Such a library runs in a
// program of its own, under limits, and hands over what it read in a form that we read ourselves: in a file
// (read_guarded) or as it comes (GuardedStream).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

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

// What such a program writes to its standard output, while it runs.
class GuardedStream {
 public:
  // Runs `program`, a path, as `program WORD... FILE SECONDS MEGABYTES`.
  GuardedStream(const std::string& program, const std::vector<std::string>& words, const std::string& file,
                const ReaderLimits& limits);
  ~GuardedStream();
  GuardedStream(const GuardedStream&) = delete;
  GuardedStream& operator=(const GuardedStream&) = delete;

  // The next bytes. Where it ends before, InputError: what it wrote to stderr where it ends with 2, an
  // error's text with its hint; else that the file cannot be read, and which limit it met or how it ended.
  void read(void* to, size_t bytes);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Within such a program, before it opens the file. Nothing is left of a crash.
void take_limits(const ReaderLimits& limits);

}  // namespace cuboct
