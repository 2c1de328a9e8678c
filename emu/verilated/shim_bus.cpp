// SPDX-License-Identifier: MIT
// The Verilated wrapper of a bus, and a bus master that carries bytes through its registers. BUS_AXI (1:
// AXI4-Lite, 0: Wishbone) comes from the command line. The master stalls at random on every channel and holds
// the wrapper to the bus's rules; a broken one ends the simulation as a failed assertion does.
#include <random>

#include "shim.h"
#if BUS_AXI
#include "Vcuboct_axi4lite.h"
using Model = Vcuboct_axi4lite;
#else
#include "Vcuboct_wishbone.h"
using Model = Vcuboct_wishbone;
#endif

namespace {

enum Register : uint8_t { kData = 0, kStatus = 4, kEnable = 8, kIdent = 12 };

struct Master : Instance<Model> {
  std::mt19937 random;
  std::string broken;
  uint32_t cycles_left = 0;
  bool woken = false;  // the interrupt was high since the last look at STATUS

  explicit Master(uint32_t seed) : Instance(seed), random(seed) {}

  bool stalls() { return (random() & 3u) == 0; }
  void rule(bool holds, const char* text) {
    if (!holds && broken.empty()) broken = std::string("the bus's rule: ") + text;
  }
  // The low half of the clock: outputs settle for the inputs.
  void settle() {
    model->clk_i = 0;
    model->eval();
  }
  void edge() {
    model->clk_i = 1;
    model->eval();
    if (cycles_left > 0) --cycles_left;
  }
  void rest() {
    settle();
    woken |= model->interrupt_o;
    edge();
  }

#if BUS_AXI
  void quiet() {
    Model& m = *model;
    m.axi_awvalid_i = m.axi_wvalid_i = m.axi_bready_i = m.axi_arvalid_i = m.axi_rready_i = 0;
  }
  // Address and data come in any order, each stays until it is taken.
  bool write(uint8_t address, uint32_t data) {
    Model& m = *model;
    bool address_there = false, data_there = false, address_taken = false, data_taken = false;
    m.axi_awaddr_i = address;
    m.axi_wdata_i = data;
    m.axi_wstrb_i = 0xf;
    for (int k = 0; k < 1000; ++k) {
      address_there = !address_taken && (address_there || !stalls());
      data_there = !data_taken && (data_there || !stalls());
      m.axi_awvalid_i = address_there;
      m.axi_wvalid_i = data_there;
      m.axi_bready_i = 0;
      settle();
      rule(!m.axi_bvalid_o, "a response to a write comes after its address and data");
      address_taken |= address_there && m.axi_awready_o;
      data_taken |= data_there && m.axi_wready_o;
      edge();
      if (address_taken && data_taken) break;
    }
    rule(address_taken && data_taken, "a write is taken");
    m.axi_awvalid_i = m.axi_wvalid_i = 0;
    int shown = -1;
    for (int k = 0; k < 1000; ++k) {
      m.axi_bready_i = !stalls();
      settle();
      rule(shown < 0 || (m.axi_bvalid_o && m.axi_bresp_o == shown),
           "a response to a write stays until it is taken");
      if (m.axi_bvalid_o) shown = m.axi_bresp_o;
      const bool taken = m.axi_bvalid_o && m.axi_bready_i;
      edge();
      if (!taken) continue;
      m.axi_bready_i = 0;
      settle();
      rule(!m.axi_bvalid_o, "a write has one response");
      edge();
      return shown == 0;
    }
    rule(false, "a write has a response");
    return false;
  }
  uint32_t read(uint8_t address) {
    Model& m = *model;
    bool there = false, taken = false;
    m.axi_araddr_i = address;
    for (int k = 0; k < 1000 && !taken; ++k) {
      there = there || !stalls();
      m.axi_arvalid_i = there;
      m.axi_rready_i = 0;
      settle();
      rule(!m.axi_rvalid_o, "data of a read comes after its address");
      taken = there && m.axi_arready_o;
      edge();
    }
    rule(taken, "a read is taken");
    m.axi_arvalid_i = 0;
    bool shown = false;
    uint32_t data = 0;
    for (int k = 0; k < 1000; ++k) {
      m.axi_rready_i = !stalls();
      settle();
      rule(!shown || (m.axi_rvalid_o && m.axi_rdata_o == data), "data of a read stays until it is taken");
      if (m.axi_rvalid_o) shown = true, data = m.axi_rdata_o;
      const bool done = m.axi_rvalid_o && m.axi_rready_i;
      rule(!m.axi_rvalid_o || m.axi_rresp_o == 0, "a read is OKAY");
      edge();
      if (!done) continue;
      m.axi_rready_i = 0;
      settle();
      rule(!m.axi_rvalid_o, "a read has one response");
      edge();
      return data;
    }
    rule(false, "a read has a response");
    return 0;
  }
#else
  void quiet() { model->wb_cyc_i = model->wb_stb_i = 0; }
  // One classic cycle; whether it was acknowledged.
  bool cycle(uint8_t address, bool write, uint32_t data, uint32_t& answer) {
    Model& m = *model;
    while (stalls()) rest();
    m.wb_cyc_i = m.wb_stb_i = 1;
    m.wb_we_i = write;
    m.wb_adr_i = address;
    m.wb_sel_i = 0xf;
    m.wb_dat_i = data;
    bool acknowledged = false, refused = false;
    for (int k = 0; k < 1000 && !acknowledged && !refused; ++k) {
      settle();
      acknowledged = m.wb_ack_o;
      refused = m.wb_err_o;
      answer = m.wb_dat_o;
      rule(!(acknowledged && refused), "an acknowledgement excludes an error");
      edge();
    }
    rule(acknowledged || refused, "a cycle ends");
    m.wb_cyc_i = m.wb_stb_i = 0;
    settle();
    rule(!m.wb_ack_o && !m.wb_err_o, "nothing is acknowledged outside a cycle");
    edge();
    return acknowledged;
  }
  bool write(uint8_t address, uint32_t data) {
    uint32_t none = 0;
    return cycle(address, true, data, none);
  }
  uint32_t read(uint8_t address) {
    uint32_t data = 0;
    rule(cycle(address, false, 0, data), "a read is acknowledged");
    return data;
  }
#endif
  const char* outcome() {
    if (!broken.empty()) return broken.c_str();
    return failure();
  }
};

}  // namespace

extern "C" {

int cuboct_abi() { return kCuboctAbi; }
void* cuboct_create(uint32_t seed) {
  auto* master = new Master(seed);
  Model& m = *master->model;
  master->quiet();  // inputs start as random bits too
  m.rst_ni = 0;
  for (int k = 0; k < 4; ++k) master->rest();
  m.rst_ni = 1;
  master->rest();
  master->rule(master->read(kIdent) == 0x43554201u, "IDENT tells the layout");
  master->rule(!master->write(kIdent, 0) && !master->write(kStatus, 0), "what cannot be written is refused");
  master->rule(master->write(kEnable, 1) && master->read(kEnable) == 1, "ENABLE holds what was written");
  return master;
}
void cuboct_destroy(void* handle) { delete static_cast<Master*>(handle); }

// Bytes to read are looked for when the interrupt tells of them.
const char* cuboct_clock_bus(void* handle, const uint8_t* rx, int rx_count, int* rx_taken, uint8_t* tx,
                             int tx_room, int* tx_count, int cycles, uint8_t* idle) {
  Master& bus = *static_cast<Master*>(handle);
  *rx_taken = *tx_count = 0;
  bus.cycles_left = static_cast<uint32_t>(cycles);
  while (bus.cycles_left > 0 && bus.broken.empty() && bus.stopped.empty()) {
    bus.rest();
    if (*rx_taken == rx_count && !bus.woken) continue;
    const uint32_t status = bus.read(kStatus);
    if (*rx_taken < rx_count) {
      // Without room a byte is refused, which is tried too.
      const bool room = status >> 16 & 0xff;
      bus.rule(room == ((status & 2) != 0), "STATUS agrees with itself about room");
      if (room || (bus.random() & 7u) == 0) {
        const bool written = bus.write(kData, rx[*rx_taken]);
        bus.rule(written || !room, "a byte with room is taken");
        *rx_taken += written;
      }
    }
    for (uint32_t waiting = status >> 8 & 0xff; waiting > 0 && *tx_count < tx_room; --waiting) {
      const uint32_t data = bus.read(kData);
      bus.rule(data >> 8 == 1, "a byte that waits is there");
      tx[(*tx_count)++] = static_cast<uint8_t>(data);
    }
    bus.woken = false;
    bus.settle();
    bus.woken = bus.model->interrupt_o;
    *idle = (status >> 2 & 1) != 0;
  }
  if (*rx_taken == rx_count && !bus.woken) *idle = (bus.read(kStatus) >> 2 & 1) != 0;
  return bus.outcome();
}

}  // extern "C"
