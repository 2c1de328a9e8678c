// SPDX-License-Identifier: MIT
// A run that goes: its frames as they come from its own process (cli/run/frame_feed.h).
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cli/view/source.h"

namespace cuboct {

class LiveRun : public ViewSource {
 public:
  // with_one_frame: paused behind the first that follows its start.
  enum class Begins : uint8_t { going, with_one_frame };
  // Listens in the run's directory, which is there. `log`: the file of the run's stderr; empty: not known.
  // InputError where another page listens there.
  LiveRun(std::string directory, std::string log, Begins begins = Begins::going);
  ~LiveRun() override;

  bool has_frames() const;
  // What there is from that frame and line on.
  struct Seen {
    std::string head, state;  // head: empty before the first frame
    std::vector<std::string> frames, lines;
  };
  Seen seen(size_t frames, size_t lines);

  std::string story() override;
  std::string news(size_t frames, size_t lines) override;
  Bytes block(size_t frame, size_t block, std::optional<size_t> row) override;
  bool command(const std::string& word) override;

 private:
  struct Kept {
    struct Place {
      off_t at;
      size_t bytes, row;
    };
    std::string json;
    std::vector<Place> blocks;
    uint64_t bytes() const;
  };
  void listen();
  void take(int run);
  bool take_message(int run);
  void make_room(uint64_t bytes);
  void store(const std::string& bytes, off_t at);
  void read_log();

  std::string directory_, log_;
  Begins begins_;
  int listener_ = -1, spool_ = -1, wake_ = -1;  // spool: the blocks of all frames, a file without a name
  off_t end_ = 0;
  std::thread thread_;

  mutable std::mutex guard_;  // of what follows
  int run_ = -1;
  std::string head_, state_ = "waiting";
  std::vector<Kept> frames_;
  std::optional<size_t> loose_;  // the disk is full: the first frame that a newer one may take the place of
  bool failed_ = false;          // a frame could not be stored, and that was said
  std::vector<std::string> lines_;
  off_t log_read_ = 0;
};

}  // namespace cuboct
