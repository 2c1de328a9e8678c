// SPDX-License-Identifier: MIT
// What a page of a run shows, stored or live. Members may be called from several threads at a time.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/trace/trace.h"

namespace cuboct {

// What a page begins with, less the frames' blocks; cli/view/web/main.js reads it.
struct Story {
  std::string head;                 // ViewFrames::head_json
  std::vector<std::string> frames;  // ViewFrame::json of each
  std::vector<Curve> curves{};
  std::vector<std::string> warnings{}, lines{};              // lines: of the run's log
  std::vector<std::pair<std::string, std::string>> facts{};  // name and text
  std::string left_out{};                                    // frames that are not there, in words
  std::string machine = "null";                              // ViewMachine::json
  std::string with = "null";                                 // ComparedRuns::with
  bool live = false, may_end = false;                        // may_end: the run can be ended from the page
  std::string steered = "null";                              // SteeredRun::steered
  std::string json() const;
};

using Bytes = std::shared_ptr<const std::string>;

class ViewSource {
 public:
  virtual ~ViewSource() = default;
  virtual std::string story() = 0;  // JSON
  // JSON: entries of frames and lines beyond those that the page has, and how the run goes.
  virtual std::string news(size_t frames, size_t lines) = 0;
  // A block of a frame, or the row of one particle; null where there is none.
  virtual Bytes block(size_t frame, size_t block, std::optional<size_t> row) = 0;
  // Of the machine: "nodes", "held" of frame k, "spans" of step k; null where there is none.
  virtual Bytes machine(const std::string&, size_t) { return nullptr; }
  virtual bool command(const std::string& word) = 0;  // false: nothing here follows it
  // What a page changes of its run (steered_run.cpp). Nothing where it cannot; empty, or why not.
  virtual std::optional<std::string> steer(const std::string&) { return std::nullopt; }
  // The run that is compared with this one; null: none.
  virtual ViewSource* beside() { return nullptr; }
};

// One row of a block.
Bytes row_of(const std::string& block, size_t bytes, size_t row);

}  // namespace cuboct
