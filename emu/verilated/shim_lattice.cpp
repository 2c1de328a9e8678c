// SPDX-License-Identifier: MIT
// The whole emitted lattice as one SystemC module, and a host that clocks it. NODES, PARTICLE_BITS,
// ID_BITS and CELL_BITS (0: nodes of one cell) come from the command line. Each clock function advances
// SystemC's time by one period.
#include <systemc>

#include "Vcuboct_lattice.h"
#include "shim.h"

namespace {

template <typename T>
using Signal = sc_core::sc_signal<T>;
template <int N>
using Vector = sc_core::sc_signal<sc_dt::sc_bv<N>>;

struct Lattice : Instance<Vcuboct_lattice> {
  Signal<bool> clk, rst_n, start, load_valid;
  Vector<32> steps, load_node;
  Vector<PARTICLE_BITS> load_data;
  Vector<8 * NODES> phase_start, phase_end;
  Vector<NODES> observe_valid, fault_valid, idle;
  Vector<NODES * PARTICLE_BITS> observe_data;
  Vector<4 * NODES> fault_code;
  Vector<NODES * ID_BITS> fault_id;
  Vector<64 * NODES> fault_number;
#if CELL_BITS > 1
  Vector<CELL_BITS> load_cell;
#elif CELL_BITS == 1
  Signal<bool> load_cell;
#endif
#if CELL_BITS > 0
  Vector<NODES * CELL_BITS> observe_cell, fault_cell;
#endif

  explicit Lattice(uint32_t seed) : Instance(seed, "lattice") {
    model->clk_i(clk);
    model->rst_ni(rst_n);
    model->start_i(start);
    model->steps_i(steps);
    model->load_valid_i(load_valid);
    model->load_node_i(load_node);
    model->load_data_i(load_data);
    model->phase_start_o(phase_start);
    model->phase_end_o(phase_end);
    model->observe_valid_o(observe_valid);
    model->observe_data_o(observe_data);
    model->fault_valid_o(fault_valid);
    model->fault_code_o(fault_code);
    model->fault_id_o(fault_id);
    model->fault_number_o(fault_number);
    model->idle_o(idle);
#if CELL_BITS > 0
    model->load_cell_i(load_cell);
    model->observe_cell_o(observe_cell);
    model->fault_cell_o(fault_cell);
#endif
  }
};

// `width` bits from `lsb` on, at most 64.
template <int N>
uint64_t field(const Vector<N>& signal, int lsb, int width) {
  const sc_dt::sc_bv<N>& bits = signal.read();
  uint64_t value = 0;
  for (int done = 0; done < width;) {
    const int at = lsb + done, shift = at % 32, part = std::min(32 - shift, width - done);
    const uint64_t word = bits.get_word(at / 32) >> shift & (~uint64_t{0} >> (64 - part));
    value |= word << done;
    done += part;
  }
  return value;
}

template <int N>
void write(Vector<N>& signal, const uint64_t* words) {
  sc_dt::sc_bv<N> bits;
  for (int w = 0; w < bits.size(); ++w)
    bits.set_word(w, static_cast<uint32_t>(words[w / 2] >> (32 * (w % 2))));
  signal.write(bits);
}

void half_period(Lattice& l, bool clk) {
  l.clk.write(clk);
  sc_core::sc_start(1, sc_core::SC_NS);
}

}  // namespace

extern "C" {

int cuboct_abi() { return kCuboctAbi; }
void* cuboct_create(uint32_t seed) { return new Lattice(seed); }
void cuboct_destroy(void* handle) { delete static_cast<Lattice*>(handle); }

const char* cuboct_clock_lattice(void* handle, const CuboctIn* host, uint32_t load_node, CuboctOut* out) {
  Lattice& l = *static_cast<Lattice*>(handle);
  l.rst_n.write(host->reset_n);
  l.start.write(host->start);
  l.steps.write(host->steps);
  l.load_valid.write(host->load_valid);
  l.load_node.write(load_node);
  if (host->load_valid) write(l.load_data, host->load_data);
#if CELL_BITS > 0
  l.load_cell.write(host->load_cell);
#endif
  half_period(l, false);
  for (int n = 0; n < NODES; ++n) {
    CuboctOut& o = out[n];
    o.phase_start = static_cast<uint8_t>(field(l.phase_start, 8 * n, 8));
    o.phase_end = static_cast<uint8_t>(field(l.phase_end, 8 * n, 8));
    o.idle = static_cast<uint8_t>(field(l.idle, n, 1));
    o.observe_valid = static_cast<uint8_t>(field(l.observe_valid, n, 1));
    if (o.observe_valid)
      for (int lsb = 0; lsb < PARTICLE_BITS; lsb += 64)
        o.observe_data[lsb / 64] =
            field(l.observe_data, n * PARTICLE_BITS + lsb, std::min(64, PARTICLE_BITS - lsb));
    o.fault_valid = static_cast<uint8_t>(field(l.fault_valid, n, 1));
    o.fault_code = static_cast<uint8_t>(field(l.fault_code, 4 * n, 4));
    o.fault_id = static_cast<uint32_t>(field(l.fault_id, n * ID_BITS, ID_BITS));
    o.fault_number = static_cast<int64_t>(field(l.fault_number, 64 * n, 64));
#if CELL_BITS > 0
    o.observe_cell = static_cast<uint32_t>(field(l.observe_cell, n * CELL_BITS, CELL_BITS));
    o.fault_cell = static_cast<uint32_t>(field(l.fault_cell, n * CELL_BITS, CELL_BITS));
#endif
  }
  half_period(l, true);
  return l.failure();
}

}  // extern "C"
