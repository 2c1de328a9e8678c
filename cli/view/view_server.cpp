// SPDX-License-Identifier: MIT
#include "cli/view/view_server.h"

#include <charconv>
#include <optional>
#include <utility>

#include "cli/view/saved_page.h"

namespace cuboct {
namespace {

// Of "machine/held/3": "held" and 3.
std::optional<std::pair<std::string, size_t>> machine_block(const std::string& path) {
  constexpr std::string_view kBegin = "machine/";
  const size_t slash = path.rfind('/');
  if (!path.starts_with(kBegin) || slash < kBegin.size()) return std::nullopt;
  std::pair<std::string, size_t> found{path.substr(kBegin.size(), slash - kBegin.size()), 0};
  const char* const end = path.data() + path.size();
  const auto number = std::from_chars(path.data() + slash + 1, end, found.second);
  if (number.ec != std::errc() || number.ptr != end) return std::nullopt;
  return found;
}

// Of "frame/12/3": 12 and 3.
std::optional<std::pair<size_t, size_t>> frame_and_block(const std::string& path) {
  constexpr std::string_view kBegin = "frame/";
  if (!path.starts_with(kBegin)) return std::nullopt;
  std::pair<size_t, size_t> found;
  const char* const end = path.data() + path.size();
  const auto frame = std::from_chars(path.data() + kBegin.size(), end, found.first);
  if (frame.ec != std::errc() || frame.ptr == end || *frame.ptr != '/') return std::nullopt;
  const auto block = std::from_chars(frame.ptr + 1, end, found.second);
  if (block.ec != std::errc() || block.ptr != end) return std::nullopt;
  return found;
}

HttpAnswer json_answer(std::string text) {
  return {200, "application/json", std::make_shared<const std::string>(std::move(text))};
}

}  // namespace

ViewServer::ViewServer(uint16_t port, std::shared_ptr<ViewSource> source)
    : source_(std::move(source)),
      page_(std::make_shared<const std::string>(served_page())),
      http_(port, [this](const HttpAsked& asked) { return answer(asked); }) {}

void ViewServer::change(std::shared_ptr<ViewSource> source) {
  const std::lock_guard lock(guard_);
  source_ = std::move(source);
}

std::shared_ptr<ViewSource> ViewServer::source() const {
  const std::lock_guard lock(guard_);
  return source_;
}

HttpAnswer ViewServer::answer(const HttpAsked& asked) { return answer_of(*source(), asked); }

HttpAnswer ViewServer::answer_of(ViewSource& from, const HttpAsked& asked) {
  ViewSource* const now = &from;
  constexpr std::string_view kWith = "with/";
  if (asked.path.starts_with(kWith)) {
    if (now->beside() == nullptr || asked.post) return {};
    return answer_of(*now->beside(), {false, asked.path.substr(kWith.size()), asked.number});
  }
  constexpr std::string_view kCommand = "command/";
  if (asked.path.starts_with(kCommand)) {
    if (!asked.post) return {405, {}, nullptr};
    return now->command(asked.path.substr(kCommand.size()))
               ? HttpAnswer{204, {}, std::make_shared<const std::string>()}
               : HttpAnswer{};
  }
  constexpr std::string_view kSteer = "steer/";
  if (asked.post && asked.path.starts_with(kSteer)) {
    const std::optional<std::string> wrong = now->steer(asked.path.substr(kSteer.size()));
    if (!wrong) return {};
    const int status = wrong->empty() ? 204 : 400;
    return {status, "text/plain; charset=utf-8", std::make_shared<const std::string>(*wrong)};
  }
  if (asked.post) return {405, {}, nullptr};
  if (asked.path.empty()) {
    was_opened_ = true;
    return {200, "text/html; charset=utf-8", page_};
  }
  if (asked.path == "story") return json_answer(now->story());
  if (asked.path == "news")
    return json_answer(now->news(asked.number("frames").value_or(0), asked.number("lines").value_or(0)));
  if (const auto place = frame_and_block(asked.path)) {
    const Bytes block = now->block(place->first, place->second, asked.number("row"));
    if (block) return {200, "application/octet-stream", block};
  }
  if (const auto part = machine_block(asked.path)) {
    const Bytes block = now->machine(part->first, part->second);
    if (block) return {200, "application/octet-stream", block};
  }
  return {};
}

}  // namespace cuboct
