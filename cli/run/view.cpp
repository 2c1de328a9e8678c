// SPDX-License-Identifier: MIT
#include "cli/run/view.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <utility>

#include "cli/run/report.h"
#include "cli/run/report_pictures.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

constexpr int kRefresh = 2;  // s

bool has_display() {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(name); value != nullptr && *value != '\0') return true;
  return false;
}

}  // namespace

bool open_in_browser(const std::string& address) {
  return has_display() && in_path("xdg-open") && in_path("setsid") &&
         Process("setsid", {"--fork", "xdg-open", address}, false, {"/dev/null", "/dev/null"}).wait() == 0;
}

template <typename Work>
void LiveView::attempt(Work work) {
  if (failed_) return;
  try {
    work();
  } catch (const std::exception& error) {
    failed_ = true;
    fmt::print(stderr, "warning: --view shows no more: {}; the run goes on\n", line_text(error.what()));
  }
}

LiveView::LiveView(std::string directory, const Loaded& loaded, uint64_t steps, bool open)
    : path_(directory + "/report.html"),
      directory_(std::move(directory)),
      title_(loaded.scene.title.empty() ? loaded.scene.path : loaded.scene.title),
      loaded_(loaded),
      steps_(steps) {
  attempt([&] {
    write("<p class=\"lead\">The run begins.</p>\n", kRefresh);
    if (open) open_page();
  });
}

void LiveView::write(const std::string& body, int refresh) {
  write_text(path_, page_head(title_, refresh) + body + "</body>\n</html>\n");
}

void LiveView::open_page() const {
  const std::string page = std::filesystem::absolute(path_).lexically_normal().string();
  if (!open_in_browser(page)) fmt::print(stderr, "view: {}\n", line_text(page));
}

void LiveView::show(const Frame& frame) {
  if (Clock::now() < next_) return;
  attempt([&] {
    const auto begin = Clock::now();
    const std::string label = fmt::format("step {} of {}    t = {:.4g} s", frame.step, steps_, frame.time);
    const std::string png = draw_frames(loaded_.scene, {label}, [&](size_t) { return frame; });
    write(
        fmt::format("<p class=\"lead\">Step {} of {}; the page follows the run.</p>\n", frame.step, steps_) +
            page_picture(png),
        kRefresh);
    next_ = Clock::now() + std::max<Clock::duration>(9 * (Clock::now() - begin), std::chrono::seconds(1));
  });
}

void LiveView::end() {
  attempt([&] {
    write_report(directory_, path_);
    ended_ = true;
  });
}

// A page that nobody writes any more must not ask for news for ever.
LiveView::~LiveView() {
  if (ended_) return;
  failed_ = false;
  attempt([&] { write("<p class=\"lead\">The run is over, and has no report.</p>\n", 0); });
}

}  // namespace cuboct
