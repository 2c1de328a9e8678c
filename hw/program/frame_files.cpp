// SPDX-License-Identifier: MIT
#include "hw/program/frame_files.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "model/base/interrupt.h"
#include "model/base/names_in.h"
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
  while (sent_ >= kUnread && fs::exists(name_of(prefix_, sent_ - kUnread)) && !interrupted())
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const std::string path = name_of(prefix_, sent_);
  TraceWriter writer(path, temporary_beside(path), false);
  std::visit([&](const auto& state) { writer.add(state); }, frame);
  Trace rest;
  rest.curves = curves_;
  writer.finish(rest);
  curves_ = bare(std::move(curves_));
  ++sent_;
}

void FrameSender::read(const std::vector<Curve>& of, uint64_t step, Values values) {
  if (curves_.empty()) curves_ = of;
  add_reading(curves_, step, values);
}

FrameReceiver::FrameReceiver(std::string prefix) : prefix_(std::move(prefix)) {
  const fs::path path(prefix_);
  const std::string start = path.filename().string() + ".";
  const fs::path directory = path.has_parent_path() ? path.parent_path() : ".";
  for (const std::string& name : names_in(directory.string()))
    if (name.starts_with(start) && name.size() > start.size() &&
        name.find_first_not_of("0123456789", start.size()) == std::string::npos)
      fs::remove(directory / name);
}

bool FrameReceiver::receive(const std::function<void(RunState)>& see, const TakeReading& read) {
  const std::string path = name_of(prefix_, received_);
  if (!fs::exists(path)) return false;
  {
    const TraceReader reader(path);
    if (read) {
      const std::vector<Curve>& curves = reader.rest().curves;
      const std::vector<Curve> of = bare(curves);
      for_each_reading(curves, [&](uint64_t step, Values values) { read(of, step, values); });
    }
    reader.frames([&](State state) { see(std::move(state)); });
    reader.bodies([&](RealFrame frame) { see(std::move(frame)); });
  }
  discard(path);
  ++received_;
  return true;
}

}  // namespace cuboct
