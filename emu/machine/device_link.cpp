// SPDX-License-Identifier: MIT
#include "emu/machine/device_link.h"

namespace cuboct::emu {

DeviceLink::DeviceLink(const sc_core::sc_module_name& name, const Timeline& timeline, const DeviceCut& boards)
    : sc_module(name), timeline_(timeline), wire_(boards) {
  SC_HAS_PROCESS(DeviceLink);
  SC_METHOD(cycle);
  sensitive << clk_i.pos();
  dont_initialize();
}

void DeviceLink::end_of_elaboration() {
  link_i->attach_receiver(in_, 0);
  link_o->attach_sender(out_, 0);
}

void DeviceLink::cycle() {
  if (timeline_.over) return;
  const uint64_t now = timeline_.edge;
  if (in_.held != 0 && ready_ && !link_i->gated()) wire_.take(now, *in_.inputs.beat[0]);
  const bool taken = valid_ && out_.ready != 0 && !link_o->gated();
  if (taken) valid_ = false;
  if (const Beat* beat = valid_ ? nullptr : wire_.come(now + 1)) {
    *out_.outputs.beat[0] = *beat;
    wire_.read();
    link_o->put();
    valid_ = true;
  } else if (taken) {
    link_o->clear();
  }
  if (const bool ready = wire_.ready(now + 1); ready != ready_) link_i->set_ready(ready_ = ready);
}

}  // namespace cuboct::emu
