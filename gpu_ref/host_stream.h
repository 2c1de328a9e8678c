// SPDX-License-Identifier: MIT
// Streams on the host: each call is run at once.
#pragma once

namespace cuboct::gpu {

class Event {};

class Stream {
 public:
  explicit Stream(int device = 0, bool = false) : device_(device) {}
  int device() const { return device_; }
  // What is asked of the stream, in its turn.
  template <class Work>
  void later(const Work& work) {
    work();
  }
  void record(Event&) {}
  void wait(const Event&) {}
  void synchronize() {}
  // All that was asked of the device's streams.
  static void finish(int) {}

 private:
  int device_;
};

}  // namespace cuboct::gpu
