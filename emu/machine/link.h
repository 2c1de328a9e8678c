// SPDX-License-Identifier: MIT
// One direction of a link as a SystemC channel: the sender's output register, the receiver's ready, and the
// gate that stalls both at random.
#pragma once

#include <systemc>

#include "emu/machine/node_model.h"
#include "emu/machine/stall.h"
#include "emu/machine/wire_faults.h"

namespace cuboct::emu {

// Counts clock edges; cycle c of the run ends at edge base + c.
struct Timeline {
  uint64_t period = 1;     // of the clock, in units of the simulator's resolution
  uint64_t edge = 0;       // the next one, or the one that is being evaluated; moves between edges
  uint64_t base = kNever;  // edge that ends cycle 0 of the run; unset before the start
  bool over = false;       // no cycle counts any more
  bool running() const { return base != kNever && edge >= base; }
  uint64_t cycle() const { return edge - base; }
};

// A node's end of its links: what the channels' current values are, gathered so that a node looks in one
// place. Links write it in SystemC's update phase and at no other time. Bit f of a mask belongs to face f.
struct LinkPins {
  uint8_t held = 0;        // incoming registers that are not empty
  uint8_t ready = 0;       // receivers of the outgoing links that are ready
  bool asleep = false;     // the node asks to be woken by a filled register
  bool heeds_all = false;  // while asleep: by a change of ready or of an acknowledgement too
  NodeInputs inputs;       // `beat`: the incoming registers, where held
  NodeOutputs outputs;     // `beat`: where the next beat is written
  sc_core::sc_event wake;
};

class LinkSender : public virtual sc_core::sc_interface {
 public:
  virtual void attach_sender(LinkPins& pins, int face) = 0;
  virtual void put() = 0;    // from the next cycle on the register holds what was written to `outputs.beat`
  virtual void clear() = 0;  // the register is empty from the next cycle on
  virtual bool gated() const = 0;   // in this cycle neither side sees the other
  virtual bool stalls() const = 0;  // whether it ever is
  // What the two ends see of a wire with faults; nothing where there are none.
  virtual const FaultyWire::View* faulty() = 0;
};

class LinkReceiver : public virtual sc_core::sc_interface {
 public:
  virtual void attach_receiver(LinkPins& pins, int face) = 0;
  virtual void set_ready(bool ready) = 0;  // from the next cycle on
  virtual void set_ack(uint16_t ack) = 0;  // likewise
  virtual bool gated() const = 0;          // as LinkSender's
  virtual const FaultyWire::View* faulty() = 0;
  virtual bool repeats() const = 0;  // the next cycle shows a beat that the register does not hold
};

class Link final : public sc_core::sc_prim_channel, public LinkSender, public LinkReceiver {
 public:
  // `number` seeds this link's stalls: sender * 6 + face. `faults`: of its wire, or none.
  Link(const char* name, const Timeline& timeline, const StallSource& stalls, uint32_t number,
       FaultyWire* faults)
      : sc_prim_channel(name), timeline_(timeline), stalls_(stalls), number_(number), faults_(faults) {}

  void attach_sender(LinkPins& pins, int face) override {
    sender_ = &pins;
    out_face_ = face;
    pins.outputs.beat[static_cast<size_t>(face)] = &buffer_[0];
  }
  void attach_receiver(LinkPins& pins, int face) override {
    receiver_ = &pins;
    in_face_ = face;
  }
  void put() override {
    flip_ = next_valid_ = true;
    request_update();
  }
  void clear() override {
    next_valid_ = false;
    request_update();
  }
  void set_ready(bool ready) override {
    next_ready_ = ready;
    request_update();
  }
  void set_ack(uint16_t ack) override {
    next_ack_ = ack;
    request_update();
  }
  const FaultyWire::View* faulty() override {
    if (faults_ == nullptr || !timeline_.running()) return nullptr;
    const bool passes = !gated();
    return &faults_->look(timeline_.cycle(),
                          {passes && valid_, &buffer_[spare_ ^ 1], passes && ready_, ack_});
  }
  bool repeats() const override { return faults_ != nullptr && faults_->repeats(); }
  bool stalls() const override { return stalls_.enabled(); }
  bool gated() const override {
    return stalls_.enabled() && timeline_.running() && stalls_.stalled(number_, timeline_.cycle());
  }

 private:
  static void set(uint8_t& mask, int face, bool value) {
    mask = static_cast<uint8_t>((mask & ~(1u << face)) | static_cast<unsigned>(value) << face);
  }
  void update() override {
    if (flip_) {
      flip_ = false;
      // The receiver reads one buffer while the sender writes the other.
      receiver_->inputs.beat[static_cast<size_t>(in_face_)] = &buffer_[spare_];
      spare_ ^= 1;
      sender_->outputs.beat[static_cast<size_t>(out_face_)] = &buffer_[spare_];
      if (receiver_->asleep) receiver_->wake.notify(sc_core::SC_ZERO_TIME);
    }
    if (sender_->heeds_all && sender_->asleep && (ready_ != next_ready_ || ack_ != next_ack_))
      sender_->wake.notify(sc_core::SC_ZERO_TIME);
    valid_ = next_valid_;
    ready_ = next_ready_;
    ack_ = next_ack_;
    set(receiver_->held, in_face_, valid_);
    set(sender_->ready, out_face_, ready_);
    sender_->inputs.ack[static_cast<size_t>(out_face_)] = ack_;
  }

  bool flip_ = false, next_valid_ = false, next_ready_ = false;
  bool valid_ = false, ready_ = false;  // current
  uint16_t next_ack_ = 0, ack_ = 0;
  uint8_t spare_ = 0;  // the buffer that the sender writes
  int out_face_ = 0, in_face_ = 0;
  LinkPins* sender_ = nullptr;
  LinkPins* receiver_ = nullptr;
  Beat buffer_[2];
  const Timeline& timeline_;
  const StallSource& stalls_;
  const uint32_t number_;
  FaultyWire* const faults_;
};

}  // namespace cuboct::emu
