// SPDX-License-Identifier: MIT
// What a command that has tools work for minutes says on stderr: a line that is rewritten, on a terminal, and
// lines that stay.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>

#include "cli/answer.h"
#include "model/base/progress.h"
#include "synth/tool.h"

namespace cuboct {

class ToolLines {
 public:
  // `label`: each line begins with it. `quiet`: nothing is said.
  explicit ToolLines(std::string label, bool quiet = false) : label_(std::move(label)), quiet_(quiet) {}

  synth::Say says() {
    return [this](const std::string& what) {
      if (!quiet_) status_.say(fmt::format("{}: {} ...", label_, what));
    };
  }
  // The first of such lines alone.
  void announce(const std::string& line) {
    if (!std::exchange(announced_, true)) tells()(line);
  }
  void wipe() { status_.wipe(); }
  synth::Say tells() {
    return [this](const std::string& line) {
      status_.wipe();
      if (quiet_) return;
      fmt::print(stderr, "{}: {}\n", label_, line);
      std::fflush(stderr);
    };
  }

 private:
  std::string label_;
  bool quiet_, announced_ = false;
  StatusLine status_;
};

// The end by Ctrl-C. `what` goes on from where they are kept: "syntheses", "stages".
inline Failed interrupted_tools(const synth::Interrupted& stop, const std::string& what) {
  return Failed(
      "interrupted; nothing was written",
      stop.kept.empty()
          ? ""
          : fmt::format("the {} that ended are in {}: the same command goes on from there", what, stop.kept));
}

}  // namespace cuboct
