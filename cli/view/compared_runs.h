// SPDX-License-Identifier: MIT
// Two runs of one body side by side: the steps of which both kept a frame, and where they first differ.
#pragma once

#include <string>

#include "cli/view/difference.h"
#include "cli/view/source.h"
#include "cli/view/stored_run.h"

namespace cuboct {

class ComparedRuns : public ViewSource {
 public:
  // `every`, `particles`: as of StoredRun, of the frames that both have. InputError where the two cannot be
  // compared.
  ComparedRuns(const std::string& a, const std::string& b, size_t every, size_t particles);

  const StoredRun& first() const { return a_; }
  const StoredRun& second() const { return b_; }
  const RunDifference& difference() const { return difference_; }
  // What the story of the first has of the second, whose story is given.
  std::string with(const Story& second) const;

  std::string story() override;
  std::string news(size_t frames, size_t lines) override { return a_.news(frames, lines); }
  Bytes block(size_t frame, size_t block, std::optional<size_t> row) override {
    return a_.block(frame, block, row);
  }
  bool command(const std::string&) override { return false; }
  ViewSource* beside() override { return &b_; }

 private:
  StoredRun a_, b_;
  RunDifference difference_;
};

// One line for people: "equal: ..." or the first difference.
std::string verdict(const RunDifference& difference, size_t frames, size_t particles);

}  // namespace cuboct
