// SPDX-License-Identifier: MIT
#include "hw/program/frame_files.h"

#include <fmt/format.h>

#include <filesystem>

#include "model/base/output.h"
#include "model/trace/trace_file.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

std::string name_of(const std::string& prefix, uint64_t number) {
  return fmt::format("{}.{}", prefix, number);
}

}  // namespace

void FrameSender::send(const RunState& frame) {
  const std::string path = name_of(prefix_, sent_);
  TraceWriter writer(path, temporary_beside(path), false);
  std::visit([&](const auto& state) { writer.add(state); }, frame);
  writer.finish({});
  ++sent_;
}

FrameReceiver::FrameReceiver(std::string prefix) : prefix_(std::move(prefix)) {
  for (uint64_t number = 0; fs::remove(name_of(prefix_, number));) ++number;
}

std::string FrameReceiver::next() const { return name_of(prefix_, received_); }

void FrameReceiver::receive(const std::function<void(RunState)>& see) {
  for (; fs::exists(next()); ++received_) {
    {
      const TraceReader reader(next());
      reader.frames([&](State state) { see(std::move(state)); });
      reader.bodies([&](RealFrame frame) { see(std::move(frame)); });
    }
    discard(next());
  }
}

}  // namespace cuboct
