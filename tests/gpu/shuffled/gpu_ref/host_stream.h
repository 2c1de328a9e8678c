// SPDX-License-Identifier: MIT
// In the place of gpu_ref/host_stream.h: streams that do nothing until somebody waits, and then in an order
// that is drawn among all that events allow. Whatever an engine only expects to come first comes last here
// some time.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <random>
#include <stdexcept>
#include <vector>

namespace cuboct::gpu {

class Stream;

class Event {
 private:
  friend class Stream;
  uint64_t issued_ = 0, reached_ = 0;
};

// All streams, and the dice that say which goes on.
struct Shuffle {
  std::vector<Stream*> streams;
  std::mt19937_64 random{1};
  uint64_t overtaken = 0;  // times that a stream went on though an earlier call of another was still to come
  uint64_t calls = 0;
  static Shuffle& all() {
    static Shuffle shuffle;
    return shuffle;
  }
};

class Stream {
 public:
  explicit Stream(int device = 0, bool = false) : device_(device) { Shuffle::all().streams.push_back(this); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() {
    synchronize();
    std::erase(Shuffle::all().streams, this);
  }
  int device() const { return device_; }

  void later(std::function<void()> work) { add({nullptr, 0, std::move(work)}); }
  void record(Event& event) {
    ++event.issued_;
    later([&event] { ++event.reached_; });
  }
  // As CUDA: for the record that was called last, if any.
  void wait(const Event& event) {
    add({&event, event.issued_, [] {}});
  }
  void synchronize() {
    while (!queue_.empty()) go_on();
  }
  static void finish(int device) {
    for (;;) {
      bool idle = true;
      for (Stream* stream : Shuffle::all().streams)
        idle = idle && (stream->device_ != device || stream->queue_.empty());
      if (idle) return;
      go_on();
    }
  }

 private:
  struct Call {
    const Event* event;
    uint64_t reached;
    std::function<void()> work;
    uint64_t number = 0;
  };
  void add(Call call) {
    call.number = Shuffle::all().calls++;
    queue_.push_back(std::move(call));
  }
  bool ready() const {
    return !queue_.empty() &&
           (!queue_.front().event || queue_.front().event->reached_ >= queue_.front().reached);
  }
  // Some stream, as far as it gets or a few calls.
  static void go_on() {
    Shuffle& all = Shuffle::all();
    std::vector<Stream*> able;
    for (Stream* stream : all.streams)
      if (stream->ready()) able.push_back(stream);
    if (able.empty()) throw std::logic_error("streams wait for one another");
    Stream& one = *able[all.random() % able.size()];
    for (uint64_t burst = 1 + all.random() % 6; burst > 0 && one.ready(); --burst) {
      const Call call = std::move(one.queue_.front());
      one.queue_.pop_front();
      for (const Stream* other : all.streams)
        if (!other->queue_.empty() && other->queue_.front().number < call.number) {
          ++all.overtaken;
          break;
        }
      call.work();
    }
  }

  int device_;
  std::deque<Call> queue_;
};

}  // namespace cuboct::gpu
