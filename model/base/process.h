// SPDX-License-Identifier: MIT
// Other programs, started without a shell, and a place for the files that pass between programs.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

namespace cuboct {

// Where a program's words go, and where it reads; an empty name: where ours do.
struct Streams {
  std::string out = "/dev/null", err = "", in = "";
};

class Process {
 public:
  // Starts `program` (looked for in PATH unless it has a slash) with these arguments, without a shell. It
  // dies with the thread that starts it, however that ends. By default its stderr is ours, its stdout is
  // dropped (results travel in files). Throws InputError where it cannot be started. `apart`: in a process
  // group of its own, where Ctrl-C does not reach it, and an interrupt of ours is passed on as SIGUSR1:
  // mpirun ends its processes on the one and tells them the other. `variables`, as NAME=VALUE, join those of
  // our environment, or replace them.
  Process(const std::string& program, const std::vector<std::string>& arguments, bool apart = false,
          const Streams& streams = {}, const std::vector<std::string>& variables = {});
  ~Process();  // ends it where nobody waited
  Process(Process&& other) noexcept;
  Process& operator=(Process&&) = delete;

  // Exit code, or -N where signal N ended it. An interrupt of ours is passed on once, whichever thread met
  // it; where `begun` says that there is nothing to save yet, the program is ended instead. `meanwhile` is
  // called every 100 ms, and again at once where it had something to do; what it throws leaves the program
  // running until the end of this object.
  int wait(const std::function<bool()>& begun = {}, const std::function<bool()>& meanwhile = {});
  // The same of a program that an interrupt of ours does not end: what it makes belongs to the end of an
  // interrupted run, such as its pictures.
  int finish();
  // As Ctrl-C in its terminal.
  void interrupt() const;
  // Whether it has ended, and waits for who asks for its exit code.
  bool ended() const;

 private:
  pid_t pid_;
  int passed_on_ = 0;  // the signal that stands for an interrupt
};

// To be called first by a program that another one starts for a program that uses Process, as mpirun does: it
// dies with the one in between. Nothing happens where nobody used Process.
void end_with_starter();

// Directory of the running program: engines with heavy needs are programs of their own, beside it.
std::string program_directory();
// Another one from now on: within a program that is not ours, such as Python.
void set_program_directory(const std::string& directory);
// The path of a program there; empty where it has none.
std::string beside(const std::string& program);

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
