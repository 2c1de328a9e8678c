// SPDX-License-Identifier: MIT
#include "cli/view/steered_run.h"

#include <fmt/format.h>

#include <charconv>
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
  return !ended_ && scene_.next();
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
  const std::string led = json_array(scene_.led(), [](const SteeredScene::Led& one) {
    const Vec3& v = one.velocity;
    return json_object({{"name", json(one.name)}, {"velocity", json(std::vector<double>{v[0], v[1], v[2]})}});
  });
  return json_object({{"led", led},
                      {"part", std::to_string(scene_.part())},
                      {"parts", std::to_string(scene_.parts())},
                      {"next", scene_.next_first() < scene_.steps() && !over_ && !ended_
                                   ? std::to_string(scene_.next_first())
                                   : "null"}});
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

bool SteeredRun::command(const std::string& word) {
  std::shared_ptr<LiveRun> run;
  {
    const std::lock_guard lock(guard_);
    if (over_) return false;
    if (word == "end") ended_ = true;
    if (!parts_.empty()) run = parts_.back().run;
  }
  return (run && run->command(word)) || word == "end";
}

std::optional<std::string> SteeredRun::steer(const std::string& words) {
  std::vector<double> numbers;
  for (size_t at = 0; at <= words.size();) {
    const size_t end = std::min(words.find('/', at), words.size());
    const std::optional<double> number = number_in(std::string_view(words).substr(at, end - at));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    at = end + 1;
  }
  if (numbers.size() != 4 || numbers[0] < 0 || numbers[0] > 1e6) return std::nullopt;
  const std::lock_guard lock(guard_);
  if (over_ || ended_) return "the run is over";
  try {
    scene_.set(static_cast<size_t>(numbers[0]), {numbers[1], numbers[2], numbers[3]});
  } catch (const InputError& error) {
    const ErrorParts parts = parts_of(error);
    return parts.hint.empty() ? parts.message : parts.message + ": " + parts.hint;
  }
  return "";
}

}  // namespace cuboct
