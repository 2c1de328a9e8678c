// SPDX-License-Identifier: MIT
#include "model/trace/guarded_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "model/base/error.h"
#include "model/base/guarded_reader.h"
#include "model/base/module.h"
#include "model/base/resources.h"
#include "model/trace/hand_over.h"

namespace cuboct {
namespace {

// HDF5 unpacks 1032 times the bytes at most, and types of memory hold up to twice what the file's do. It
// takes a frame at a time; we keep all of them.
ReaderLimits limits_of(const std::string& path, uint64_t free) {
  std::error_code none;  // a file that is not there is the program's to tell
  const uint64_t bytes = std::filesystem::file_size(path, none);
  ReaderLimits limits = reader_limits(none ? 0 : bytes);
  limits.megabytes = 1024 + std::min<uint64_t>(none ? 0 : 2064 * (bytes >> 20), free >> 20);
  return limits;
}

std::string reader_program() {
  std::string path = part_path(kTraceReader);
  if (path.empty())
    throw InputError(fmt::format("no program {} beside this one: it reads traces", kTraceReader),
                     "build or install all of cuboct");
  return path;
}

// Takes what the program hands over, as far as there is memory.
class Taker {
 public:
  Taker(const char* what, const std::string& path)
      : path_(path), left_(free_memory()), in_(reader_program(), {what}, path, limits_of(path, left_)) {}

  void move(void* to, size_t bytes) { in_.read(to, bytes); }
  void expect(uint64_t count, size_t size) {
    if (count > left_ / size)
      throw InputError(fmt::format("cannot read {}: it takes more memory than is free", path_));
    left_ -= count * size;
  }

 private:
  const std::string path_;
  uint64_t left_;  // bytes
  GuardedStream in_;
};

template <typename T>
T taken(const char* what, const std::string& path) {
  Taker from(what, path);
  HandOver pass(from);
  T value;
  pass(value);
  return value;
}

}  // namespace

Trace guarded_trace(const std::string& path) {
  Taker from(kReadTrace, path);
  HandOver pass(from);
  Trace trace;
  pass(trace);
  for (TracePart part{}; pass(part), part != TracePart::end;) {
    if (part == TracePart::frame)
      pass(trace.frames.emplace_back());
    else
      pass(trace.bodies.emplace_back());
  }
  return trace;
}

LeftState guarded_left_state(const std::string& path) { return taken<LeftState>(kReadLeftState, path); }

Rasters guarded_rasters(const std::string& path) { return taken<Rasters>(kReadRasters, path); }

}  // namespace cuboct
