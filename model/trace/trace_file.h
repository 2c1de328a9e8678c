// SPDX-License-Identifier: MIT
// A trace on disk, frame by frame: neither its writer nor its reader holds more than one. Layout in
// docs/reference/trace.md.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "model/trace/trace.h"

namespace cuboct {

// Same trace, same bytes, however long it took to come.
class TraceWriter {
 public:
  // Writes to `temporary`; finish() renames it to `path`. What was added is in the temporary file, flushed,
  // if the program dies, and so is the head. `packed` as in write_trace. Throws InputError where the file
  // cannot be made. Keeps the pointer `head`: what makes metres and seconds of the numbers
  // (model/trace/trace_head.h), or null.
  TraceWriter(const std::string& path, const std::string& temporary, bool packed = true,
              const TraceHead* head = nullptr);
  ~TraceWriter();  // removes the temporary file where finish() was not reached
  TraceWriter(const TraceWriter&) = delete;
  TraceWriter& operator=(const TraceWriter&) = delete;

  // Frames of one kind, ascending in step. Throws InputError where the disk has no room: the frame is then
  // left out, and the next one may fit.
  void add(const State& frame);
  void add(const RealFrame& frame);

  // Everything but frames, of which `trace` has none; the file is whole then.
  void finish(const Trace& trace);
  // Leaves the temporary file as it is, for want of a better one.
  void leave();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class TraceReader {
 public:
  // Throws InputError where the file is no trace, or damaged.
  explicit TraceReader(const std::string& path);
  ~TraceReader();
  TraceReader(const TraceReader&) = delete;
  TraceReader& operator=(const TraceReader&) = delete;

  const Trace& rest() const;  // all but frames and bodies
  // One after another, ascending in step.
  void frames(const std::function<void(State)>& see) const;
  void bodies(const std::function<void(RealFrame)>& see) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cuboct
