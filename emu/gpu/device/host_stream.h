// SPDX-License-Identifier: MIT
// Streams on the host. Each call is run at once; or, for tests, once somebody waits, and then in an order
// that is drawn among all that events allow: whatever an engine only expects to come first comes last some
// time.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <random>
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
  bool on = false;  // to be set before the first stream is made
  std::vector<Stream*> streams;
  std::mt19937_64 random{1};
  uint64_t overtaken = 0;  // times that a stream went on though an earlier call of another was still to come
  uint64_t calls = 0;
  static Shuffle& all();
};

class Stream {
 public:
  explicit Stream(int device = 0, bool = false);
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream();
  int device() const { return device_; }

  // What is asked of the stream, in its turn.
  template <class Work>
  void later(const Work& work) {
    if (Shuffle::all().on)
      add({nullptr, 0, work});
    else
      work();
  }
  void record(Event& event);
  // As CUDA: for the record that was called last, if any.
  void wait(const Event& event);
  void synchronize();
  // All that was asked of the device's streams.
  static void finish(int device);

 private:
  struct Call {
    const Event* event;
    uint64_t reached;
    std::function<void()> work;
    uint64_t number = 0;
  };
  void add(Call call);
  bool ready() const;
  static void go_on();

  int device_;
  std::deque<Call> queue_;
};

}  // namespace cuboct::gpu
