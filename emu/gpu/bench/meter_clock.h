// SPDX-License-Identifier: MIT
// The time in which speed and energy are measured. Tests hand in one of their own, which no busy machine
// changes.
#pragma once

#include <functional>
#include <memory>

namespace cuboct::gpu {

class MeterClock {
 public:
  virtual ~MeterClock() = default;
  virtual double now() = 0;  // s
  virtual void sleep(double seconds) = 0;

  // Somebody who looks now and then, until this object goes.
  class Watch {
   public:
    virtual ~Watch() = default;
  };
  // `look` returns the time to the next look, s; below 0: it looks no more.
  virtual std::unique_ptr<Watch> watch(std::function<double()> look) = 0;
};

// The machine's steady clock. It looks from a thread of its own.
MeterClock& steady_clock();

}  // namespace cuboct::gpu
