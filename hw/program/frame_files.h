// SPDX-License-Identifier: MIT
// Frames that a program hands over as they come. Each is a file of its own, PREFIX.0, PREFIX.1 and so on: a
// trace of one state (docs/reference/trace.md), with what was read since the one before. A file of such a
// name is whole, and goes when it has been read.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "model/run/engine.h"
#include "model/trace/curve_readings.h"

namespace cuboct {

class FrameSender {
 public:
  explicit FrameSender(std::string prefix) : prefix_(std::move(prefix)) {}

  // Waits while kUnread frames have not been read, unless an interrupt ends the run: files take no more room
  // than that. Throws InputError where the disk has no room; the frame is then left out, and the next one may
  // fit.
  void send(const RunState& frame);
  // Goes with the next frame.
  void read(const std::vector<Curve>& of, uint64_t step, Values values);
  static constexpr uint64_t kUnread = 16;

 private:
  std::string prefix_;
  std::vector<Curve> curves_;
  uint64_t sent_ = 0;
};

class FrameReceiver {
 public:
  // What an earlier program left under these names goes.
  explicit FrameReceiver(std::string prefix);

  // Calls `see` with the next frame in the order in which they were sent, if it is there: whether it was.
  // Before that `read`, with what came along. Throws InputError for a damaged file.
  bool receive(const std::function<void(RunState)>& see, const TakeReading& read = {});

 private:
  std::string prefix_;
  uint64_t received_ = 0;
};

}  // namespace cuboct
