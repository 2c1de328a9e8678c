// SPDX-License-Identifier: MIT
// One direction of a link as a SystemC channel: the sender's output register, the receiver's ready, and the
// gate that stalls both at random.
#pragma once

#include <systemc>

#include "emu/systemc/node_model.h"
#include "emu/systemc/stall.h"

namespace cuboct::emu {

// Counts clock edges; cycle c of the run ends at edge base + c.
struct Timeline {
  uint64_t period = 1;         // of the clock, in units of the simulator's resolution
  uint64_t base = UINT64_MAX;  // edge that ends cycle 0 of the run; unset before the start
  uint64_t edge() const { return sc_core::sc_time_stamp().value() / period; }
  bool running() const { return base != UINT64_MAX && edge() >= base; }
  uint64_t cycle() const { return edge() - base; }
};

class LinkSender : public virtual sc_core::sc_interface {
 public:
  virtual bool ready() const = 0;          // link_ready_i of the sender
  virtual void put(const Beat& beat) = 0;  // the register holds `beat` from the next cycle on
  virtual void clear() = 0;                // the register is empty from the next cycle on
  virtual bool holds() const = 0;          // the register is not empty, stalled or not
};

class LinkReceiver : public virtual sc_core::sc_interface {
 public:
  virtual bool valid() const = 0;  // link_valid_i of the receiver
  virtual const Beat& beat() const = 0;
  virtual bool holds() const = 0;                        // as LinkSender's
  virtual void set_ready(bool ready) = 0;                // from the next cycle on
  virtual void wake_with(sc_core::sc_event& event) = 0;  // notified when the register is filled
};

class Link : public sc_core::sc_prim_channel, public LinkSender, public LinkReceiver {
 public:
  // `number` seeds this link's stalls: sender * 6 + face.
  Link(const char* name, const Timeline& timeline, const StallSource& stalls, uint32_t number)
      : sc_prim_channel(name), timeline_(timeline), stalls_(stalls), number_(number) {}

  bool ready() const override { return ready_ && !gated(); }
  void put(const Beat& beat) override {
    buffer_[1 - current_] = beat;
    flip_ = next_valid_ = true;
    request_update();
  }
  void clear() override {
    next_valid_ = false;
    request_update();
  }
  bool holds() const override { return valid_; }
  bool valid() const override { return valid_ && !gated(); }
  const Beat& beat() const override { return buffer_[current_]; }
  void set_ready(bool ready) override {
    next_ready_ = ready;
    request_update();
  }
  void wake_with(sc_core::sc_event& event) override { wake_ = &event; }

 private:
  bool gated() const {
    return stalls_.enabled() && timeline_.running() && stalls_.stalled(number_, timeline_.cycle());
  }
  void update() override {
    if (flip_) {
      current_ = 1 - current_;
      flip_ = false;
      if (wake_ != nullptr) wake_->notify(sc_core::SC_ZERO_TIME);
    }
    valid_ = next_valid_;
    ready_ = next_ready_;
  }

  const Timeline& timeline_;
  const StallSource& stalls_;
  const uint32_t number_;
  Beat buffer_[2];  // what the receiver sees, and what the sender writes
  int current_ = 0;
  bool flip_ = false, valid_ = false, next_valid_ = false, ready_ = false, next_ready_ = false;
  sc_core::sc_event* wake_ = nullptr;
};

}  // namespace cuboct::emu
