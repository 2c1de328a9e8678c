// SPDX-License-Identifier: MIT
#include "cli/view/watch_run.h"

#include <fmt/format.h>
#include <poll.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>

#include "cli/run/view.h"
#include "cli/view/live_run.h"
#include "cli/view/stored_run.h"
#include "cli/view/view_server.h"
#include "model/base/directory_lock.h"
#include "model/base/interrupt.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

constexpr int kLook = 100;  // ms

void tell(const WatchAsked& asked, const ViewServer& server) {
  asked.answer.say("{}\n", server.address());
  asked.answer.close(json_object({{"address", json(server.address())}}));
  std::fflush(stdout);  // who reads a pipe is to have it now
  if (asked.opens) open_in_browser(server.address());
}

void wait_for_interrupt() {
  while (!interrupted()) poll(nullptr, 0, kLook);
}

std::shared_ptr<StoredRun> stored(const WatchAsked& asked) {
  return std::make_shared<StoredRun>(asked.directory, asked.every, asked.particles);
}

// What a run left takes the place of what came of it; a killed one left nothing that could.
void show_what_is_left(const WatchAsked& asked, ViewServer& server) {
  try {
    server.change(stored(asked));
  } catch (const InputError& error) {
    fmt::print(stderr, "{}; the page keeps the frames that came\n", line_text(error.what()));
  }
}

}  // namespace

int watch_directory(const WatchAsked& asked) {
  catch_interrupts();
  if (!is_locked(asked.directory)) {
    ViewServer server(asked.port, stored(asked));
    tell(asked, server);
    wait_for_interrupt();
    return 0;
  }
  const auto live = std::make_shared<LiveRun>(asked.directory, "");
  ViewServer server(asked.port, live);
  tell(asked, server);
  while (!interrupted() && !live->is_over() && is_locked(asked.directory)) poll(nullptr, 0, kLook);
  if (!interrupted()) show_what_is_left(asked, server);
  wait_for_interrupt();
  return 0;
}

int watch_run(const WatchAsked& asked, const std::vector<std::string>& words) {
  catch_interrupts();
  const bool made = !std::filesystem::exists(asked.directory);
  make_directory(asked.directory);
  const Scratch scratch;
  const std::string summary = scratch.path("summary"), log = scratch.path("log");
  auto live = std::make_shared<LiveRun>(asked.directory, log);
  std::optional<ViewServer> server(std::in_place, asked.port, live);
  Process run(beside("cuboct"), words, false, {summary, log});
  bool told = false;
  // The address once there is something to see: a scene that cannot be read is refused as `cuboct run`
  // refuses it.
  const int code = run.wait({}, [&] {
    if (!told && live->has_frames()) tell(asked, *server), told = true;
    return false;
  });
  fmt::print(stderr, "{}", block_text(read_text(log)));
  if (!told && !live->has_frames()) {  // refused: nothing is left of it
    server.reset(), live.reset();
    std::error_code none;
    if (made) std::filesystem::remove(asked.directory, none);  // where it is empty
    return code;
  }
  if (!told) tell(asked, *server);
  if (!asked.answer.json) fmt::print("{}", block_text(read_text(summary)));
  std::fflush(stdout);
  show_what_is_left(asked, *server);
  wait_for_interrupt();
  return 0;
}

}  // namespace cuboct
