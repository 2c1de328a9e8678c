// SPDX-License-Identifier: MIT
// A run of parts, one after the other (steered_scene.h), as one: the frames of all, with the steps of the
// whole run.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "cli/view/live_run.h"
#include "cli/view/source.h"
#include "cli/view/steered_scene.h"

namespace cuboct {

class SteeredRun : public ViewSource {
 public:
  explicit SteeredRun(SteeredScene& scene) : scene_(scene) {}

  // The next part; false: there is none, or the page has ended the run.
  bool next();
  // The part at hand did so many steps.
  void ended(uint64_t done);
  // How the part that is to come begins: a page that waited for one frame waits again behind it.
  LiveRun::Begins begins();
  // Its frames come from here on.
  void begin(std::shared_ptr<LiveRun> run);
  // Once true: the part at hand is to end here, whole, so that a change comes into force. It has been told.
  bool cuts();
  void end();
  bool has_frames() const;

  std::string story() override;
  std::string news(size_t frames, size_t lines) override;
  Bytes block(size_t frame, size_t block, std::optional<size_t> row) override;
  bool command(const std::string& word) override;
  std::optional<std::string> steer(const std::string& words) override;

 private:
  struct Part {
    std::shared_ptr<LiveRun> run;
    uint64_t first;  // step of the whole run
    bool twice;      // its first frame is the last one of the part before
  };
  LiveRun::Seen seen(size_t frames, size_t lines);
  std::string steered() const;  // JSON: what can be changed, and from when on

  mutable std::mutex guard_;
  SteeredScene& scene_;
  std::vector<Part> parts_;
  LiveRun::Begins begins_ = LiveRun::Begins::going;
  // By the page: ended, and paused, so that changes wait. over: all is done. cut: the part at hand is told.
  bool ended_ = false, paused_ = false, over_ = false, cut_ = false;
};

}  // namespace cuboct
