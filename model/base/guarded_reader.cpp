// SPDX-License-Identifier: MIT
#include "model/base/guarded_reader.h"

#include <fmt/format.h>

#include <csignal>
#include <cstring>
#include <fstream>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/process.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

// Libraries put the rest of the file into their messages.
std::string first_line(const std::string& path) {
  constexpr size_t kMost = 80;
  std::string line;
  std::ifstream in(path);
  std::getline(in, line);
  if (line.size() > kMost) line = line.substr(0, kMost) + " ...";
  return line_text(line);
}

std::string outcome(int status, const ReaderLimits& limits, const std::string& complaint) {
  if (status == 2 && !complaint.empty()) return complaint;
  if (status == -SIGXCPU)
    return fmt::format("reading it takes more than {} s of processor time", limits.seconds);
  if (status == -SIGALRM) return fmt::format("reading it takes more than {} s", 10 * limits.seconds);
  if (status < 0) return fmt::format("it crashes the library that reads it ({})", strsignal(-status));
  return fmt::format("reading it fails with code {}", status);
}

}  // namespace

ReaderLimits reader_limits(uint64_t bytes) {
  const uint64_t megabytes = bytes >> 20;
  return {.seconds = 4 + megabytes, .megabytes = 1024 + 200 * megabytes};
}

void read_guarded(const std::string& program, const std::string& file, const std::string& result,
                  const ReaderLimits& limits) {
  const std::string said = result + ".said";
  const int status =
      Process(program, {file, result, std::to_string(limits.seconds), std::to_string(limits.megabytes)},
              false, {"/dev/null", said})
          .wait();
  if (status == 0) return;
  if (interrupted()) throw InputError("interrupted");
  throw InputError(outcome(status, limits, first_line(said)));
}

}  // namespace cuboct
