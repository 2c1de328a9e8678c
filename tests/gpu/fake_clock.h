// SPDX-License-Identifier: MIT
// Time that passes where a test says so.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "emu/gpu/bench/meter_clock.h"

namespace cuboct::gpu {

class FakeClock : public MeterClock {
 public:
  double now() override { return now_; }
  void sleep(double seconds) override { pass(seconds); }
  std::unique_ptr<Watch> watch(std::function<double()> look) override {
    look_ = std::move(look);
    next_ = now_;
    pass(0);
    return std::make_unique<Looking>(*this);
  }

  // The one who watches looks whenever it wanted to.
  void pass(double seconds) {
    const double end = now_ + seconds;
    while (look_ && next_ <= end) {
      now_ = next_;
      const double wait = look_();
      next_ = now_ + wait;
      if (wait < 0) look_ = nullptr;
    }
    now_ = end;
  }
  const double* time() const { return &now_; }

 private:
  struct Looking : Watch {
    explicit Looking(FakeClock& clock) : clock(clock) {}
    ~Looking() override { clock.look_ = nullptr; }
    FakeClock& clock;
  };

  double now_ = 1000, next_ = 0;  // s
  std::function<double()> look_;
};

}  // namespace cuboct::gpu
