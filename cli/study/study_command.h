// SPDX-License-Identifier: MIT
// What commands share whose results are kept in a directory, and which go on where they were.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <utility>

#include "cli/answer.h"
#include "hw/program/bounds.h"
#include "hw/program/options.h"
#include "model/base/directory_lock.h"
#include "model/base/interrupt.h"
#include "study/sweep/interrupted.h"

namespace cuboct {

inline constexpr const char* kGoesOn = "interrupted; the same command goes on where it was";

inline void add_study_to(Command& command, std::string& study) {
  command.option("study", study, "study file (TOML)", "STUDY").required();
}
// `of`: "study", whose name with `ending` the directory has without --out.
inline void add_out_to(Command& command, std::string& out, const std::string& of, const std::string& ending) {
  command.option("--out", out,
                 fmt::format("directory for results; default: that of the {}'s name with {}", of, ending),
                 "DIR");
}
inline void add_jobs_to(Command& command, int& jobs, bool& anyway, const std::string& what) {
  command.option("--jobs", jobs, what + "; default: one per core", "N").range(1, 4096);
  add_anyway_to(command, anyway);
}

inline std::string out_of(const std::string& out, const std::string& file, const std::string& ending) {
  return out.empty() ? std::filesystem::path(file).stem().string() + ending : out;
}

// Keeps the directory from others while `work` is done, and says of Ctrl-C that all is kept.
template <class Work>
auto kept_in(const std::string& out, const std::string& command, Work&& work) {
  const DirectoryLock lock(out, command);
  catch_interrupts();
  try {
    return std::forward<Work>(work)();
  } catch (const study::Interrupted&) {
    throw Failed(kGoesOn);
  }
}

// False and a line on stderr where there is no gnuplot: "no charts: ...".
template <class Draw>
bool drawn(const char* what, Draw&& draw) {
  try {
    std::forward<Draw>(draw)();
    return true;
  } catch (const InputError& error) {
    fmt::print(stderr, "no {}: {}\n", what, error.what());
    return false;
  }
}

}  // namespace cuboct
