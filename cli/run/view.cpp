// SPDX-License-Identifier: MIT
#include "cli/run/view.h"

#include <fmt/format.h>
#include <poll.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "cli/run/report.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

constexpr int kLook = 20;  // ms

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

RunPage::RunPage(const std::string& directory, bool opens) : directory_(directory) {
  const std::string address = scratch_.path("address"), errors = scratch_.path("errors");
  try {
    std::vector<std::string> words{"view", directory, "--while-run"};
    if (!opens) words.emplace_back("--no-open");
    process_.emplace(beside("cuboct"), words, false, Streams{address, errors});
    // It listens once it tells its address: the first frame is not to come before.
    std::string told;
    while (told.empty() && !process_->ended()) {
      told = read_text(address);
      poll(nullptr, 0, kLook);
    }
    if (told.empty()) throw InputError(read_text(errors));
    fmt::print(stderr, "view: {}", block_text(told));
  } catch (const std::exception& error) {
    process_.reset();
    fmt::print(stderr, "warning: --view shows no page: {}; the run goes on\n", line_text(error.what()));
  }
}

void RunPage::report() const {
  try {
    write_report(directory_, directory_ + "/report.html");
  } catch (const std::exception& error) {
    fmt::print(stderr, "warning: --view leaves no report: {}\n", line_text(error.what()));
  }
}

void RunPage::wait(bool by_page) {
  if (by_page) forget_interrupt();
  if (process_) process_->wait();
}

}  // namespace cuboct
