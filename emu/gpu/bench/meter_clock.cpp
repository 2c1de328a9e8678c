// SPDX-License-Identifier: MIT
#include "emu/gpu/bench/meter_clock.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

namespace cuboct::gpu {
namespace {

using Seconds = std::chrono::duration<double>;

class Thread : public MeterClock::Watch {
 public:
  explicit Thread(std::function<double()> look)
      : thread_([look = std::move(look)](const std::stop_token& stop) {
          std::mutex mutex;
          std::condition_variable_any told;
          for (std::unique_lock lock(mutex); !stop.stop_requested();) {
            const double wait = look();
            if (wait < 0) return;
            told.wait_for(lock, stop, Seconds(wait), [] { return false; });
          }
        }) {}

 private:
  std::jthread thread_;
};

class Steady : public MeterClock {
 public:
  double now() override { return Seconds(std::chrono::steady_clock::now().time_since_epoch()).count(); }
  void sleep(double seconds) override { std::this_thread::sleep_for(Seconds(seconds)); }
  std::unique_ptr<Watch> watch(std::function<double()> look) override {
    return std::make_unique<Thread>(std::move(look));
  }
};

}  // namespace

MeterClock& steady_clock() {
  static Steady clock;
  return clock;
}

}  // namespace cuboct::gpu
