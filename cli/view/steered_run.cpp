// SPDX-License-Identifier: MIT
#include "cli/view/steered_run.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/base/json.h"

namespace cuboct {
namespace {

// Of a frame's entry (ViewFrame::json).
uint64_t step_of(const std::string& entry) {
  constexpr std::string_view kBegin = "{\"step\":";
  uint64_t step = 0;
  if (entry.starts_with(kBegin))
    std::from_chars(entry.data() + kBegin.size(), entry.data() + entry.size(), step);
  return step;
}

std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

bool SteeredRun::next() {
  const std::lock_guard lock(guard_);
  cut_ = false;
  return !ended_ && scene_.next();
}

void SteeredRun::ended(uint64_t done) {
  const std::lock_guard lock(guard_);
  scene_.ended(done);
}

LiveRun::Begins SteeredRun::begins() {
  const std::lock_guard lock(guard_);
  paused_ = begins_ == LiveRun::Begins::with_one_frame;
  return std::exchange(begins_, LiveRun::Begins::going);
}

// Before its first frame a part has nobody who listens.
bool SteeredRun::cuts() {
  const std::lock_guard lock(guard_);
  if (cut_ || ended_ || paused_ || parts_.empty() || !scene_.has_change()) return false;
  return cut_ = parts_.back().run->command("cut");
}

void SteeredRun::begin(std::shared_ptr<LiveRun> run) {
  const std::lock_guard lock(guard_);
  bool twice = false;
  if (!parts_.empty()) {
    const std::vector<std::string> before = parts_.back().run->seen(0, 0).frames;
    twice = !before.empty() && parts_.back().first + step_of(before.back()) == scene_.first();
  }
  parts_.push_back({std::move(run), scene_.first(), twice});
}

void SteeredRun::end() {
  const std::lock_guard lock(guard_);
  over_ = true;
}

bool SteeredRun::has_frames() const {
  const std::lock_guard lock(guard_);
  return !parts_.empty() && parts_.front().run->has_frames();
}

LiveRun::Seen SteeredRun::seen(size_t frames, size_t lines) {
  const std::lock_guard lock(guard_);
  LiveRun::Seen all;
  size_t frame = 0, line = 0;
  for (size_t k = 0; k < parts_.size(); ++k) {
    LiveRun::Seen one = parts_[k].run->seen(0, 0);
    if (k == 0) all.head = one.head;
    all.state = one.state;
    const size_t twice = parts_[k].twice && !one.frames.empty();
    for (size_t n = twice; n < one.frames.size(); ++n) {
      if (frame++ < frames) continue;
      std::string& entry = all.frames.emplace_back(std::move(one.frames[n]));
      entry.back() = ',';
      entry += fmt::format("\"first\":{}}}", parts_[k].first);
    }
    for (std::string& text : one.lines)
      if (line++ >= lines) all.lines.push_back(std::move(text));
  }
  if (over_)
    all.state = "ended";
  else if (all.state == "ended")
    all.state = "waiting";  // for the next part
  return all;
}

std::string SteeredRun::steered() const {
  const std::lock_guard lock(guard_);
  const auto three = [](const Vec3& v) { return json(std::vector<double>{v[0], v[1], v[2]}); };
  const SteeredScene::Wanted& wanted = scene_.wanted();
  const std::string led = json_array(wanted.led, [&](const SteeredScene::Led& one) {
    return json_object({{"name", json(one.name)}, {"velocity", three(one.velocity)}});
  });
  return json_object({{"led", led},
                      {"gravity", three(wanted.gravity)},
                      {"damping", json(wanted.damping)},
                      {"part", std::to_string(scene_.part())},
                      {"first", std::to_string(scene_.first())},
                      {"steps", std::to_string(scene_.steps())},
                      {"waits", json(scene_.has_change())},
                      {"over", json(over_ || ended_)},
                      {"radius", json(scene_.usual_radius())},
                      {"for", std::to_string(scene_.usual_steps())}});
}

std::string SteeredRun::story() {
  LiveRun::Seen now = seen(0, 0);
  Story story{now.head.empty() ? "null" : now.head, std::move(now.frames)};
  story.lines = std::move(now.lines);
  story.live = story.may_end = true;
  story.steered = steered();
  return story.json();
}

std::string SteeredRun::news(size_t frames, size_t lines) {
  const LiveRun::Seen now = seen(frames, lines);
  return json_object({{"frames", json_array(now.frames)},
                      {"lines", json(now.lines)},
                      {"state", json(now.state)},
                      {"steered", steered()},
                      {"whole", json(false)}});
}

Bytes SteeredRun::block(size_t frame, size_t block, std::optional<size_t> row) {
  std::shared_ptr<LiveRun> run;
  {
    const std::lock_guard lock(guard_);
    for (size_t k = 0; k < parts_.size() && !run; ++k) {
      const size_t all = parts_[k].run->seen(0, 0).frames.size(), twice = parts_[k].twice && all > 0;
      if (frame + twice < all)
        run = parts_[k].run, frame += twice;
      else
        frame -= all - twice;
    }
  }
  return run ? run->block(frame, block, row) : nullptr;
}

// Of a run that waits, changes come into force as it goes on.
bool SteeredRun::command(const std::string& word) {
  std::shared_ptr<LiveRun> run;
  {
    const std::lock_guard lock(guard_);
    if (over_) return false;
    if (word == "end") ended_ = true;
    const bool goes = word == "continue" || word == "step";
    if (goes && scene_.has_change()) {
      if (word == "step") begins_ = LiveRun::Begins::with_one_frame;
      paused_ = false;
      return true;
    }
    if (goes || word == "pause") paused_ = word != "continue";
    if (!parts_.empty()) run = parts_.back().run;
  }
  return (run && run->command(word)) || word == "end";
}

// "velocity/K/X/Y/Z", "gravity/X/Y/Z", "damping/C" and "pull/PARTICLE/RADIUS/X/Y/Z/STEPS".
std::optional<std::string> SteeredRun::steer(const std::string& words) {
  const size_t slash = words.find('/');
  const std::string what = words.substr(0, slash);
  std::vector<double> n;
  for (size_t at = slash; at < words.size();) {
    const size_t end = std::min(words.find('/', at + 1), words.size());
    const std::optional<double> number = number_in(std::string_view(words).substr(at + 1, end - at - 1));
    if (!number) return std::nullopt;
    n.push_back(*number);
    at = end;
  }
  const auto whole = [&](size_t k) { return n[k] >= 0 && n[k] <= 1e15 && n[k] == std::floor(n[k]); };
  const auto count = [&](size_t k) { return static_cast<uint64_t>(n[k]); };
  const std::lock_guard lock(guard_);
  try {
    if (over_ || ended_) return "the run is over";
    if (what == "velocity" && n.size() == 4 && whole(0))
      scene_.set_velocity(count(0), {n[1], n[2], n[3]});
    else if (what == "gravity" && n.size() == 3)
      scene_.set_gravity({n[0], n[1], n[2]});
    else if (what == "damping" && n.size() == 1)
      scene_.set_damping(n[0]);
    else if (what == "pull" && n.size() == 6 && whole(0) && whole(5))
      scene_.pull({count(0), n[1], {n[2], n[3], n[4]}, count(5)});
    else
      return std::nullopt;
  } catch (const InputError& error) {
    const ErrorParts parts = parts_of(error);
    return parts.hint.empty() ? parts.message : parts.message + ": " + parts.hint;
  }
  return "";
}

}  // namespace cuboct
