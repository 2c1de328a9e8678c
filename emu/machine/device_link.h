// SPDX-License-Identifier: MIT
// A link between devices as a SystemC module: it reads one channel and writes another, which lie at its two
// ends. What it shows comes from a register, so that its latency is at least one cycle.
#pragma once

#include <systemc>

#include "emu/machine/device_wire.h"
#include "emu/machine/link.h"

namespace cuboct::emu {

class DeviceLink : public sc_core::sc_module {
 public:
  sc_core::sc_in<bool> clk_i{"clk_i"};
  sc_core::sc_port<LinkReceiver> link_i{"link_i"};  // of the sending node
  sc_core::sc_port<LinkSender> link_o{"link_o"};    // to the receiving node

  DeviceLink(const sc_core::sc_module_name& name, const Timeline& timeline, const DeviceCut& boards);

 private:
  void end_of_elaboration() override;
  void cycle();

  const Timeline& timeline_;
  DeviceWire wire_;
  LinkPins in_, out_;
  bool ready_ = false, valid_ = false;  // the registers as this module left them
};

}  // namespace cuboct::emu
