// SPDX-License-Identifier: MIT
// The Verilated top of a board: its serial line, cycle by cycle.
#include "Vcuboct_board_top.h"
#include "shim.h"

namespace {

// Tops differ in the polarity of buttons and lamps, and name them so.
template <typename M>
auto release_button(M& m, int) -> decltype(void(m.reset_ni)) {
  m.reset_ni = 1;
}
template <typename M>
auto release_button(M& m, long) -> decltype(void(m.reset_i)) {
  m.reset_i = 0;
}
template <typename M>
auto idle_lamp(M& m, int) -> decltype(bool(m.led_idle_no)) {
  return !m.led_idle_no;
}
template <typename M>
auto idle_lamp(M& m, long) -> decltype(bool(m.led_idle_o)) {
  return m.led_idle_o;
}

struct Top : Instance<Vcuboct_board_top> {
  using Instance::Instance;
};

}  // namespace

extern "C" {

int cuboct_abi() { return kCuboctAbi; }
void* cuboct_create(uint32_t seed) {
  auto* top = new Top(seed);
  release_button(*top->model, 0);
  top->model->uart_rx_i = 1;
  return top;
}
void cuboct_destroy(void* handle) { delete static_cast<Top*>(handle); }

const char* cuboct_clock_board(void* handle, const uint8_t* rx, uint8_t* tx, int cycles, uint8_t* idle) {
  Top& top = *static_cast<Top*>(handle);
  Vcuboct_board_top& m = *top.model;
  for (int k = 0; k < cycles; ++k) {
    m.uart_rx_i = rx[k];
    m.clk_i = 0;
    m.eval();
    tx[k] = m.uart_tx_o;
    m.clk_i = 1;
    m.eval();
  }
  *idle = idle_lamp(m, 0);
  return top.failure();
}

}  // extern "C"
