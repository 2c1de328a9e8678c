// SPDX-License-Identifier: MIT
#include "cli/run/frame_feed.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "model/base/interrupt.h"

namespace cuboct {
namespace {

constexpr int kShare = 25;                // of the run's time, one part
constexpr timeval kLong{2, 0};            // a page that takes nothing for so long is left
constexpr int kLook = 100;                // ms
constexpr std::chrono::seconds kAway{2};  // until a page that could not be shown a frame is tried again

// The address of a socket is at most 107 bytes: it goes through a descriptor of the directory.
// `flags`: of the socket.
template <typename Use>
int with_address(const std::string& directory, int flags, Use use) {
  const int place = open(directory.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (place < 0) return -1;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = fmt::format("/proc/self/fd/{}/{}", place, kViewSocket);
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  int made = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | flags, 0);
  if (made >= 0 && use(made, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int error = errno;
    close(made);
    made = -1;
    errno = error;
  }
  const int error = errno;
  close(place);
  errno = error;
  return made;
}

}  // namespace

// EAGAIN where a page has more that wait than it takes: it is stopped. To wait for it could take for ever.
int connect_in(const std::string& directory) {
  const int made = with_address(directory, SOCK_NONBLOCK, connect);
  if (made >= 0) fcntl(made, F_SETFL, fcntl(made, F_GETFL) & ~O_NONBLOCK);
  return made;
}

int listen_in(const std::string& directory) {
  return with_address(directory, 0, [](int made, const sockaddr* address, socklen_t size) {
    return bind(made, address, size) != 0 ? -1 : listen(made, 4);
  });
}

bool is_viewed(const std::string& directory) {
  const int page = directory.empty() ? -1 : connect_in(directory);
  if (page < 0) return false;
  const bool own = is_own(page);
  close(page);
  return own;
}

bool is_own(int socket) {
  ucred other{};
  socklen_t size = sizeof other;
  return getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &other, &size) == 0 && other.uid == geteuid();
}

FrameFeed::FrameFeed(std::string directory, const TraceHead& head, const FrameStyle& style, size_t particles,
                     const std::string& engine)
    : directory_(std::move(directory)), engine_(engine), form_(head, style, particles, particles) {}

FrameFeed::~FrameFeed() { leave(); }

void FrameFeed::leave() {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
  paused_ = has_all_ = false;
}

// The head comes before the first frame.
bool FrameFeed::begin() {
  if (socket_ >= 0) return true;
  socket_ = connect_in(directory_);
  if (socket_ < 0) return false;
  setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &kLong, sizeof kLong);
  return is_own(socket_) && send(form_.head_json(engine_), {});
}

bool FrameFeed::send(const std::string& json, const std::vector<std::string>& blocks) {
  const auto all = [&](const void* from, size_t bytes) {
    const char* at = static_cast<const char*>(from);
    while (bytes > 0) {
      const ssize_t sent = ::send(socket_, at, bytes, MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) return false;
      at += sent, bytes -= static_cast<size_t>(sent);
    }
    return true;
  };
  const FeedSizes sizes{json.size(), blocks.size()};
  bool whole = all(&sizes, sizeof sizes);
  for (size_t k = 0; k < blocks.size(); ++k) {
    const FeedBlock block{blocks[k].size(), form_.blocks()[k].row()};
    whole = whole && all(&block, sizeof block);
  }
  whole = whole && all(json.data(), json.size());
  for (const std::string& block : blocks) whole = whole && all(block.data(), block.size());
  return whole;
}

// What the page has asked for since it was last heard. `waits`: for more, while it wants a pause.
void FrameFeed::obey(bool waits) {
  while (socket_ >= 0 && !interrupted()) {
    pollfd from{socket_, POLLIN, 0};
    // Not without end: a signal may come between the look at it and the wait.
    const int there = poll(&from, 1, waits && paused_ ? kLook : 0);
    if ((there < 0 && errno == EINTR) || (there == 0 && waits && paused_)) continue;
    if (there <= 0) return;
    char word = 0;
    if (recv(socket_, &word, 1, MSG_PEEK) <= 0)
      return leave();  // the page's program is gone: the run goes on
    // It stands for a frame of its own: the next wait takes it.
    if (!waits && paused_ && static_cast<FeedWord>(word) == FeedWord::one_frame) return;
    if (recv(socket_, &word, 1, 0) <= 0) return leave();
    switch (static_cast<FeedWord>(word)) {
      case FeedWord::pause:
        paused_ = true;
        break;
      case FeedWord::go_on:
        paused_ = false;
        break;
      case FeedWord::one_frame:
        paused_ = true;
        return;
      case FeedWord::end:
        has_ended_ = true;
        raise(SIGINT);
        return;
      case FeedWord::cut:
        is_cut_ = true;
        break;
    }
  }
}

bool FrameFeed::is_cut() {
  char word = 0;
  while (socket_ >= 0 && recv(socket_, &word, 1, MSG_DONTWAIT) == 1)
    is_cut_ = is_cut_ || static_cast<FeedWord>(word) == FeedWord::cut;
  return is_cut_;
}

void FrameFeed::show(const Frame& frame, const State* state, bool last) {
  obey(false);
  if (!paused_ && !last && Clock::now() < next_) return;
  const auto began = Clock::now();
  const auto spent = [&] { return (kShare - 1) * (Clock::now() - began); };
  // What a page that is stuck costs is a twenty-fifth, too.
  const auto give_up = [&] {
    if (socket_ >= 0) next_ = Clock::now() + std::max<Clock::duration>(spent(), kAway);
    leave();
  };
  if (!begin()) return give_up();
  ViewFrame made = form_.make(frame, state);
  made.read = curves_;
  (has_all_ ? fresh_ : all_).append_to(made.read);
  if (!send(made.json(), made.blocks)) return give_up();
  has_all_ = true;
  fresh_.clear();
  next_ = Clock::now() + spent();
  obey(true);
}

void FrameFeed::read(const std::vector<Curve>& of, uint64_t step, Values values) {
  if (curves_.empty()) curves_ = of;
  all_.add(step, values);
  fresh_.add(step, values);
}

}  // namespace cuboct
