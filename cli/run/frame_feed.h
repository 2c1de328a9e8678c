// SPDX-License-Identifier: MIT
// The end of a run that `cuboct view` holds the other end of: frames go to who listens in the run's
// directory, and wait while that asks for a pause. docs/reference/view.md has what passes between them.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/command.h"
#include "model/trace/curve_readings.h"
#include "model/trace/view_frame.h"

namespace cuboct {

// The socket in a run's directory at which a page listens.
inline constexpr const char* kViewSocket = ".view";

// A byte from the page to the run.
// cut: an interrupt follows, which ends the run as whole.
enum class FeedWord : char { pause = 'p', go_on = 'g', one_frame = 's', end = 'e', cut = 'c' };

// A message: this, `blocks` times the next, the JSON, and the blocks' bytes. The first message of a run has
// its head and no blocks.
struct FeedSizes {
  uint64_t json = 0, blocks = 0;
};
struct FeedBlock {
  uint64_t bytes = 0, row = 0;  // row: of one particle
};

// Connects to the socket in a directory, or listens there: a file descriptor, or -1. However long the
// directory's name is.
int connect_in(const std::string& directory);
int listen_in(const std::string& directory);
// Whether a page listens there now.
bool is_viewed(const std::string& directory);
// Whether the other end is this user's.
bool is_own(int socket);

// Nothing here ends a run, but an end that the page asks for, which is as Ctrl-C.
class FrameFeed {
 public:
  // `particles`: at most so many of each frame. Keeps the references.
  FrameFeed(std::string directory, const TraceHead& head, const FrameStyle& style, size_t particles,
            const std::string& engine);
  ~FrameFeed();
  FrameFeed(const FrameFeed&) = delete;
  FrameFeed& operator=(const FrameFeed&) = delete;

  // Takes a twenty-fifth of the run's time at most: frames that come sooner are left out, but for those that
  // a page waits for one by one, and but for the `last`. Without a page, a system call.
  void show(const Frame& frame, const State* state, bool last);
  // Goes with the next frame that is shown.
  void read(const std::vector<Curve>& of, uint64_t step, Values values);
  // Whether the page has asked for the run's end.
  bool has_ended() const { return has_ended_; }
  // Of a run that was interrupted: whether a page did that, to whom what was done is all of it.
  bool is_cut();

 private:
  using Clock = std::chrono::steady_clock;
  bool begin();
  bool send(const std::string& json, const std::vector<std::string>& blocks);
  void obey(bool waits);
  void leave();

  std::string directory_, engine_;
  ViewFrames form_;
  // Of all readings, for a page that comes late; and of those since the last frame that was shown.
  static constexpr size_t kAll = 2048, kFresh = 256;
  ThinnedReadings all_{kAll}, fresh_{kFresh};
  std::vector<Curve> curves_;  // without readings
  int socket_ = -1;
  bool paused_ = false, has_all_ = false;  // has_all: the page, but for the fresh ones
  bool has_ended_ = false, is_cut_ = false;
  Clock::time_point next_ = Clock::now();
};

}  // namespace cuboct
