// SPDX-License-Identifier: MIT
// Other programs, started without a shell, and a place for the files that pass between programs.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace cuboct {

// Where a program's words go; an empty name: where ours go.
struct Streams {
  std::string out = "/dev/null", err = "";
};

class Process {
 public:
  // Starts `program` (looked for in PATH unless it has a slash) with these arguments, without a shell; by
  // default its stderr is ours, its stdout is dropped (results travel in files). Throws InputError where it
  // cannot be started.
  // `apart`: in a process group of its own, where Ctrl-C does not reach it, and an interrupt of ours is
  // passed on as SIGUSR1: mpirun ends its processes on the one and tells them the other.
  Process(const std::string& program, const std::vector<std::string>& arguments, bool apart = false,
          const Streams& streams = {});
  ~Process();  // ends it where nobody waited
  Process(Process&& other) noexcept;
  Process& operator=(Process&&) = delete;

  // Exit code, or -N where signal N ended it. An interrupt of ours is passed on once, whichever thread met it.
  int wait();

 private:
  pid_t pid_;
  int passed_on_ = 0;  // the signal that stands for an interrupt
};

// Directory of the running program: engines with heavy needs are programs of their own, beside it.
std::string program_directory();

// Whether a directory of PATH has it.
bool in_path(const std::string& program);

// A directory of its own below the system's temporary one, removed at the end.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string path(const std::string& name) const { return directory_ + "/" + name; }

 private:
  std::string directory_;
};

}  // namespace cuboct
