// SPDX-License-Identifier: MIT
#include "cli/view/live_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "cli/run/frame_feed.h"
#include "model/base/directory_lock.h"
#include "model/base/error.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

// What the frames leave free of their disk: so many bytes, or this part of it where that is less.
constexpr uint64_t kFree = 256'000'000, kFreePart = 10;

constexpr uint64_t kMostJson = 1 << 26, kMostBlocks = 1000, kMostBytes = uint64_t{1} << 36;

bool receive(int from, void* to, size_t bytes) {
  char* at = static_cast<char*>(to);
  while (bytes > 0) {
    const ssize_t got = recv(from, at, bytes, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got, bytes -= static_cast<size_t>(got);
  }
  return true;
}

// In the directory of the run, as nothing else is written to.
int unnamed_file(const std::string& directory) {
  int file = open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) {  // a file system that has none
    const std::string name = temporary_beside(directory + "/.view.frames");
    file = open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file >= 0) unlink(name.c_str());
  }
  if (file < 0)
    throw InputError(fmt::format("cannot write into the directory {}: {}", directory, std::strerror(errno)));
  return file;
}

struct Disk {
  uint64_t free = UINT64_MAX / 2, margin = kFree;  // bytes
};

Disk disk_of(int file) {
  struct statvfs disk {};
  if (fstatvfs(file, &disk) != 0) return {};
  return {disk.f_bavail * disk.f_frsize, std::min(kFree, disk.f_blocks * disk.f_frsize / kFreePart)};
}

std::string socket_path(const std::string& directory) { return directory + "/" + kViewSocket; }

}  // namespace

LiveRun::LiveRun(std::string directory, std::string log, Begins begins)
    : directory_(std::move(directory)), log_(std::move(log)), begins_(begins) {
  const int other = connect_in(directory_);
  const bool stopped = other < 0 && errno == EAGAIN, own = other >= 0 && is_own(other);
  if (other >= 0) close(other);
  if (stopped || own)
    throw InputError(fmt::format("another cuboct view follows {}", directory_), "its page shows the run");
  unlink(socket_path(directory_).c_str());  // of one that was killed
  spool_ = unnamed_file(directory_);
  listener_ = listen_in(directory_);
  wake_ = eventfd(0, EFD_CLOEXEC);
  if (listener_ < 0 || wake_ < 0) {
    const int error = errno;
    for (const int file : {listener_, spool_, wake_})
      if (file >= 0) close(file);
    throw InputError(fmt::format("cannot listen in {}: {}", directory_, std::strerror(error)));
  }
  thread_ = std::thread([this] { listen(); });
}

LiveRun::~LiveRun() {
  const uint64_t one = 1;
  if (write(wake_, &one, sizeof one) < 0) return;  // cannot be: nobody else counts it up
  {
    const std::lock_guard lock(guard_);
    if (run_ >= 0) shutdown(run_, SHUT_RDWR);
  }
  thread_.join();
  unlink(socket_path(directory_).c_str());
  for (const int file : {listener_, spool_, wake_}) close(file);
}

bool LiveRun::has_frames() const {
  const std::lock_guard lock(guard_);
  return !frames_.empty();
}

void LiveRun::listen() {
  for (;;) {
    pollfd from[] = {{listener_, POLLIN, 0}, {wake_, POLLIN, 0}};
    if (poll(from, 2, -1) < 0 && errno != EINTR) return;
    if (from[1].revents != 0) return;
    if (from[0].revents == 0) continue;
    const int run = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (run < 0) continue;
    if (is_own(run)) take(run);
    close(run);
  }
}

void LiveRun::take(int run) {
  {
    const std::lock_guard lock(guard_);
    run_ = run;
    state_ = "running";
    // Also to who only looks whether somebody listens, and sends no frame.
    constexpr char kOneFrame[] = {static_cast<char>(FeedWord::pause), static_cast<char>(FeedWord::one_frame)};
    if (begins_ == Begins::with_one_frame && frames_.empty() &&
        ::send(run, kOneFrame, sizeof kOneFrame, MSG_NOSIGNAL | MSG_DONTWAIT) == sizeof kOneFrame)
      state_ = "paused";
  }
  try {
    while (take_message(run)) continue;
  } catch (const std::exception& error) {  // a full disk: what came stays, the run goes on
    const std::lock_guard lock(guard_);
    if (!std::exchange(failed_, true))
      lines_.push_back(fmt::format("a frame is left out: {}", line_text(error.what())));
  }
  const bool cut = ftruncate(spool_, end_) == 0;  // a frame that is not whole
  const std::lock_guard lock(guard_);
  if (!cut && !std::exchange(failed_, true)) lines_.push_back("the file of the frames cannot be cut");
  run_ = -1;
  state_ = frames_.empty() ? "waiting" : "ended";  // who only looked whether somebody listens sent none
}

bool LiveRun::take_message(int run) {
  FeedSizes sizes;
  if (!receive(run, &sizes, sizeof sizes) || sizes.json > kMostJson || sizes.blocks > kMostBlocks)
    return false;
  std::vector<FeedBlock> blocks(sizes.blocks);
  if (!receive(run, blocks.data(), blocks.size() * sizeof(FeedBlock))) return false;
  Kept kept;
  kept.json.resize(sizes.json);
  if (!receive(run, kept.json.data(), kept.json.size())) return false;
  uint64_t whole = 0;
  for (const FeedBlock& block : blocks) {
    if (block.bytes > kMostBytes || block.row == 0) return false;
    whole += block.bytes;
  }
  make_room(whole);
  std::string bytes;
  off_t at = end_;
  for (const FeedBlock& block : blocks) {
    bytes.resize(block.bytes);
    if (!receive(run, bytes.data(), bytes.size())) return false;
    store(bytes, at);
    kept.blocks.push_back({at, bytes.size(), block.row});
    at += static_cast<off_t>(bytes.size());
  }
  end_ = at;
  const std::lock_guard lock(guard_);
  if (blocks.empty())
    head_ = std::move(kept.json);
  else
    frames_.push_back(std::move(kept));
  return true;
}

uint64_t LiveRun::Kept::bytes() const {
  uint64_t sum = 0;
  for (const Place& block : blocks) sum += block.bytes;
  return sum;
}

void LiveRun::store(const std::string& bytes, off_t at) {
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t wrote =
        pwrite(spool_, bytes.data() + done, bytes.size() - done, at + static_cast<off_t>(done));
    if (wrote <= 0) throw std::runtime_error(std::strerror(errno));
    done += static_cast<size_t>(wrote);
  }
}

// For a frame of so many bytes. Once the disk is full, the newest frames take half of what was left free at
// most, and of large ones the newest alone is kept.
void LiveRun::make_room(uint64_t bytes) {
  const Disk disk = disk_of(spool_);
  const std::lock_guard lock(guard_);
  if (disk.free < disk.margin + bytes && !loose_) {
    loose_ = frames_.size();
    lines_.push_back("the disk is nearly full: of the frames from here on the page keeps the newest alone");
  }
  if (!loose_) return;
  uint64_t taken = bytes;
  for (size_t k = *loose_; k < frames_.size(); ++k) taken += frames_[k].bytes();
  for (; *loose_ < frames_.size() && taken > disk.margin / 2; ++*loose_) {
    Kept& old = frames_[*loose_];
    taken -= old.bytes();
    if (!old.blocks.empty() && fallocate(spool_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, old.blocks[0].at,
                                         static_cast<off_t>(old.bytes())) != 0)
      throw std::runtime_error(std::strerror(errno));
    old.blocks.clear();
  }
  if (bytes > disk_of(spool_).free / 2) throw std::runtime_error(std::strerror(ENOSPC));
}

void LiveRun::read_log() {
  if (log_.empty()) return;
  const int file = open(log_.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  std::string text;
  char piece[1 << 14];
  for (ssize_t got;
       (got = pread(file, piece, sizeof piece, log_read_ + static_cast<off_t>(text.size()))) > 0;)
    text.append(piece, static_cast<size_t>(got));
  close(file);
  const size_t whole = text.rfind('\n');  // a line that is still being written comes later
  if (whole == std::string::npos) return;
  for (size_t from = 0; from <= whole;) {
    const size_t to = text.find('\n', from);
    lines_.push_back(line_text(text.substr(from, to - from)));
    from = to + 1;
  }
  log_read_ += static_cast<off_t>(whole + 1);
}

LiveRun::Seen LiveRun::seen(size_t frames, size_t lines) {
  const std::lock_guard lock(guard_);
  read_log();
  const bool lost = state_ == "ended" && is_locked(directory_);  // the run goes on without us, or writes
  Seen seen{head_, lost ? "lost" : state_, {}, {}};
  for (size_t k = std::min(frames, frames_.size()); k < frames_.size(); ++k)
    seen.frames.push_back(frames_[k].json);
  for (size_t k = std::min(lines, lines_.size()); k < lines_.size(); ++k) seen.lines.push_back(lines_[k]);
  return seen;
}

std::string LiveRun::story() {
  Seen now = seen(0, 0);
  Story story{now.head.empty() ? "null" : now.head, std::move(now.frames)};
  story.lines = std::move(now.lines);
  story.live = story.may_end = true;
  return story.json();
}

std::string LiveRun::news(size_t frames, size_t lines) {
  const Seen now = seen(frames, lines);
  return json_object({{"frames", json_array(now.frames)},
                      {"lines", json(now.lines)},
                      {"state", json(now.state)},
                      {"whole", json(false)}});
}

Bytes LiveRun::block(size_t frame, size_t block, std::optional<size_t> row) {
  Kept::Place place{};
  {
    const std::lock_guard lock(guard_);
    if (frame >= frames_.size() || block >= frames_[frame].blocks.size()) return nullptr;
    place = frames_[frame].blocks[block];
  }
  if (row) {
    if (*row >= place.bytes / place.row) return nullptr;
    place.at += static_cast<off_t>(*row * place.row);
    place.bytes = place.row;
  }
  std::string bytes(place.bytes, '\0');
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t got =
        pread(spool_, bytes.data() + done, bytes.size() - done, place.at + static_cast<off_t>(done));
    if (got <= 0) throw std::runtime_error("a frame cannot be read back");
    done += static_cast<size_t>(got);
  }
  const std::lock_guard lock(guard_);
  if (frames_[frame].blocks.empty()) return nullptr;  // a newer one has taken its place meanwhile
  return std::make_shared<const std::string>(std::move(bytes));
}

bool LiveRun::command(const std::string& word) {
  constexpr std::pair<const char*, FeedWord> kWords[] = {{"pause", FeedWord::pause},
                                                         {"continue", FeedWord::go_on},
                                                         {"step", FeedWord::one_frame},
                                                         {"end", FeedWord::end},
                                                         {"cut", FeedWord::cut}};
  const auto* known = std::ranges::find(kWords, word, [](const auto& one) { return std::string(one.first); });
  if (known == std::end(kWords)) return false;
  const std::lock_guard lock(guard_);
  const char byte = static_cast<char>(known->second);
  if (run_ < 0 || ::send(run_, &byte, 1, MSG_NOSIGNAL | MSG_DONTWAIT) != 1) return false;
  if (known->second == FeedWord::pause || known->second == FeedWord::one_frame) state_ = "paused";
  if (known->second == FeedWord::go_on) state_ = "running";
  return true;
}

}  // namespace cuboct
