// SPDX-License-Identifier: MIT
#include "cli/view/watch_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "cli/run/outputs.h"
#include "cli/run/view.h"
#include "cli/view/compared_runs.h"
#include "cli/view/live_run.h"
#include "cli/view/steered_run.h"
#include "cli/view/stored_run.h"
#include "cli/view/view_server.h"
#include "model/base/directory_lock.h"
#include "model/base/error.h"
#include "model/base/input_file.h"
#include "model/base/interrupt.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/text.h"
#include "model/trace/guarded_trace.h"

namespace cuboct {
namespace {

constexpr int kLook = 100;  // ms

// Of what a program is told as an argument all users of the machine can read: the browser is given a file
// that sends it to the address.
bool open_apart(const std::string& address, const Scratch& scratch) {
  const std::string path = scratch.path("view.html");
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return false;
  const std::string text = fmt::format(
      "<!DOCTYPE html>\n<title>cuboct view</title>\n<meta name=\"referrer\" content=\"no-referrer\">\n"
      "<meta http-equiv=\"refresh\" content=\"0; url={0}\">\n<a href=\"{0}\">cuboct view</a>\n",
      address);
  const bool whole = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  close(file);
  return whole && open_in_browser(path);
}

// Whether a browser has been opened.
bool tell(const WatchAsked& asked, const ViewServer& server, const Scratch& scratch) {
  asked.answer.say("{}\n", server.address());
  asked.answer.close(json_object({{"address", json(server.address())}}));
  std::fflush(stdout);  // who reads a pipe is to have it now
  return asked.opens && open_apart(server.address(), scratch);
}

void wait_for_interrupt() {
  while (!interrupted()) poll(nullptr, 0, kLook);
}

std::shared_ptr<StoredRun> stored(const WatchAsked& asked) {
  return std::make_shared<StoredRun>(asked.directory, asked.every, asked.particles);
}

// What a run left takes the place of what came of it, and its directory is free for another page; a killed
// one left nothing that could.
bool show_what_is_left(const WatchAsked& asked, ViewServer& server, std::shared_ptr<LiveRun>& live) {
  try {
    server.change(stored(asked));
  } catch (const InputError& error) {
    fmt::print(stderr, "{}; the page keeps the frames that came\n", line_text(error.what()));
    return false;
  }
  live.reset();
  return true;
}

// A directory that is made unless it is there, and goes again where nothing came into it.
class Place {
 public:
  explicit Place(const std::string& path) : path_(path), made_(!std::filesystem::exists(path)) {
    make_directory(path);
  }
  ~Place() {
    std::error_code none;
    if (made_) std::filesystem::remove(path_, none);
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

 private:
  std::string path_;
  bool made_;
};

// A page shows all of a run: the run would have to leave a part out.
void refuse_part(const WatchAsked& asked, const std::string& what) {
  for (const auto& [given, option] : {std::pair{asked.every > 1, "--every"}, {asked.part, "--particles"}})
    if (given)
      throw InputError(fmt::format("{} is of a run that is over, and {} is not", option, what),
                       "without it the page follows the run");
}

}  // namespace

int watch_directory(const WatchAsked& asked) {
  catch_interrupts();
  const Scratch scratch;
  if (!is_locked(asked.directory)) {
    ViewServer server(asked.port, stored(asked));
    tell(asked, server, scratch);
    wait_for_interrupt();
    return 0;
  }
  refuse_part(asked, asked.directory);
  auto live = std::make_shared<LiveRun>(asked.directory, "");
  ViewServer server(asked.port, live);
  const bool opened = tell(asked, server, scratch);
  // A run that was killed leaves nothing, and may be begun anew.
  while (live && !interrupted()) {
    while (!interrupted() && is_locked(asked.directory)) poll(nullptr, 0, kLook);
    if (asked.while_run && !opened && !server.was_opened()) return 0;
    if (interrupted() || show_what_is_left(asked, server, live)) break;
    while (!interrupted() && !is_locked(asked.directory)) poll(nullptr, 0, kLook);
  }
  wait_for_interrupt();
  return 0;
}

int watch_two(const WatchAsked& asked, const std::string& with) {
  catch_interrupts();
  const Scratch scratch;
  ViewServer server(asked.port,
                    std::make_shared<ComparedRuns>(asked.directory, with, asked.every, asked.particles));
  tell(asked, server, scratch);
  wait_for_interrupt();
  return 0;
}

int watch_run(const WatchAsked& asked, const std::vector<std::string>& words) {
  catch_interrupts();
  refuse_part(asked, "one that is started");
  const Place place(asked.directory);
  const Scratch scratch;
  const std::string summary = scratch.path("summary"), log = scratch.path("log");
  auto live = std::make_shared<LiveRun>(asked.directory, log);
  ViewServer server(asked.port, live);
  Process run(beside("cuboct"), words, false, {summary, log});
  bool told = false;
  // The address once there is something to see: a scene that cannot be read is refused as `cuboct run`
  // refuses it.
  const int code = run.wait({}, [&] {
    if (!told && live->has_frames()) tell(asked, server, scratch), told = true;
    return false;
  });
  fmt::print(stderr, "{}", block_text(read_text(log)));
  if (!told && !live->has_frames()) return code;  // refused: nothing is left of it
  if (!told) tell(asked, server, scratch);
  if (!asked.answer.json) fmt::print("{}", block_text(read_text(summary)));
  std::fflush(stdout);
  if (!interrupted()) show_what_is_left(asked, server, live);
  wait_for_interrupt();
  return 0;
}

int watch_steered(const WatchAsked& asked, SteeredScene& scene, const std::vector<std::string>& words) {
  catch_interrupts();
  refuse_part(asked, "one that is started");
  make_directory(asked.directory);
  const Scratch scratch;
  auto all = std::make_shared<SteeredRun>(scene);
  ViewServer server(asked.port, all);
  bool told = false;
  int code = 0;
  while (code == 0 && !interrupted() && all->next()) {
    const std::string summary = scratch.path("summary"), log = scratch.path(scene.stage() + ".log");
    make_directory(scene.place());
    auto live = std::make_shared<LiveRun>(scene.place(), log, all->begins());
    all->begin(live);
    std::vector<std::string> of_part = words;
    of_part.insert(of_part.end(), {"--stage", scene.stage()});
    Process run(beside("cuboct"), of_part, false, {summary, log});
    code = run.wait({}, [&] {
      if (!told && live->has_frames()) tell(asked, server, scratch), told = true;
      if (all->cuts()) run.interrupt();
      return false;
    });
    fmt::print(stderr, "{}", block_text(read_text(log)));
    if (const std::string trace = scene.place() + "/trace.h5"; is_file(trace))
      all->ended(guarded_left_state(trace).step);
    // A part with warnings goes on; one that did not come to its end does not.
    if (code == 1 && !interrupted() && read_record(scene.place()).state == "finished") code = 0;
    if (!told && !all->has_frames()) return code;
    if (!told) tell(asked, server, scratch), told = true;
  }
  all->end();
  wait_for_interrupt();
  return 0;
}

}  // namespace cuboct
