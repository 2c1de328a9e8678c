// SPDX-License-Identifier: MIT
// The whole emitted lattice as one SystemC module, and a host that clocks it. NODES, PARTICLE_BITS,
// ID_BITS and CELL_BITS (0: nodes of one cell) come from the command line. Each clock function advances
// SystemC's time by one period.
#include <systemc>
#include <type_traits>

#include "Vcuboct_lattice.h"
#include "shim.h"

namespace {

template <typename T>
using Signal = sc_core::sc_signal<T>;
template <int N>
using Vector = sc_core::sc_signal<sc_dt::sc_bv<N>>;
// A port of one bit is a bool.
template <int N>
using Of = std::conditional_t<N == 1, Signal<bool>, Vector<N>>;

// Registers between the host and each node (cuboct_spread).
constexpr int levels() {
  int count = 0;
  for (long reach = 1; reach < NODES; reach *= 8) ++count;
  return count;
}

struct Lattice : Instance<Vcuboct_lattice> {
  Signal<bool> clk, rst_n, start, load_valid, select;
  Vector<32> steps, node;
  Vector<PARTICLE_BITS> load_data;
  // Of the node that a host observes; of no use here.
  Signal<bool> all_idle, busy, settled, faulty, one_observe_valid, one_fault_valid;
  Vector<PARTICLE_BITS> one_observe_data;
  Vector<4> one_fault_code;
  Of<ID_BITS> one_fault_id;
  Vector<64> one_fault_number;
#if CELL_BITS > 0
  Of<CELL_BITS> one_observe_cell, one_fault_cell;
#endif
  // Of all nodes.
  Vector<8 * NODES> phase_start, phase_end;
  Of<NODES> observe_valid, fault_valid, idle;
  Vector<NODES * PARTICLE_BITS> observe_data;
  Vector<4 * NODES> fault_code;
  Of<NODES * ID_BITS> fault_id;
  Vector<64 * NODES> fault_number;
#if CELL_BITS > 0
  Of<CELL_BITS> load_cell;
  Of<NODES * CELL_BITS> observe_cell, fault_cell;
#endif

  explicit Lattice(uint32_t seed) : Instance(seed, "lattice") {
    model->clk_i(clk);
    model->rst_ni(rst_n);
    model->start_i(start);
    model->steps_i(steps);
    model->load_valid_i(load_valid);
    model->load_data_i(load_data);
    model->select_i(select);
    model->node_i(node);
    model->idle_o(all_idle);
    model->busy_o(busy);
    model->settled_o(settled);
    model->faulty_o(faulty);
    model->observe_valid_o(one_observe_valid);
    model->observe_data_o(one_observe_data);
    model->fault_valid_o(one_fault_valid);
    model->fault_code_o(one_fault_code);
    model->fault_id_o(one_fault_id);
    model->fault_number_o(one_fault_number);
    model->probe_phase_start_o(phase_start);
    model->probe_phase_end_o(phase_end);
    model->probe_observe_valid_o(observe_valid);
    model->probe_observe_data_o(observe_data);
    model->probe_fault_valid_o(fault_valid);
    model->probe_fault_code_o(fault_code);
    model->probe_fault_id_o(fault_id);
    model->probe_fault_number_o(fault_number);
    model->probe_idle_o(idle);
#if CELL_BITS > 0
    model->load_cell_i(load_cell);
    model->observe_cell_o(one_observe_cell);
    model->fault_cell_o(one_fault_cell);
    model->probe_observe_cell_o(observe_cell);
    model->probe_fault_cell_o(fault_cell);
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

uint64_t field(const Signal<bool>& signal, int, int) { return signal.read(); }

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
  l.node.write(load_node);
  if (host->load_valid) write(l.load_data, host->load_data);
#if CELL_BITS > 0
  l.load_cell.write(host->load_cell);
#endif
  half_period(l, false);
  // What has been loaded is on its way before it; each node starts so many cycles later, idle until then.
  if (host->start)
    for (int k = 0; k < levels(); ++k) {
      half_period(l, true);
      l.start.write(false);
      half_period(l, false);
    }
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
