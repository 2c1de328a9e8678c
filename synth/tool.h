// SPDX-License-Identifier: MIT
// Other people's programs: which Debian package has them, their logs, how they end.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace cuboct::synth {

// Thrown where a signal asked to stop.
struct Interrupted {
  std::string kept = {};  // where the stages that ended are kept; empty: none is
};

// A line for people, without the name of the command.
using Say = std::function<void(const std::string&)>;
// Hears of a tool before it runs, with 0, and then each second.
using Hears = std::function<void(const std::string& what, int seconds)>;

// A tool that ended badly. `what()` has its own error line; the log is whole.
class ToolFailed : public std::runtime_error {
 public:
  ToolFailed(const std::string& tool, const std::string& log, const std::string& complaint);
  std::string log;  // file name, without directories
};

// Throws InputError with the Debian package where PATH has no such program.
void need(const std::string& program);

// Runs tools one after the other in one directory, each with a log of its own: everything that it says.
class Runner {
 public:
  Runner(std::string directory, Hears hears);

  // The log is NAME.log. Throws ToolFailed, Interrupted.
  void run(const std::string& what, const std::string& name, const std::string& program,
           const std::vector<std::string>& arguments) const;
  std::string path(const std::string& name) const { return directory_ + "/" + name; }
  void write(const std::string& name, const std::string& text) const;

 private:
  std::string directory_;
  Hears hears_;
};

// First line of what `program argument` prints, or empty: a version.
std::string first_line(const std::string& program, const std::string& argument);

// The line of a log in which a tool says what it dislikes: the last with "ERROR" or "Error:", or the last of
// all.
std::string complaint_of(const std::string& log);

}  // namespace cuboct::synth
