// SPDX-License-Identifier: MIT
// The whole emitted lattice as one Verilated model. NODES, PARTICLE_BITS and ID_BITS come from the command
// line.
#include "Vcuboct_lattice.h"
#include "shim.h"

namespace {

struct Lattice : Instance<Vcuboct_lattice> {
  using Instance::Instance;
  uint64_t particles[words_of(NODES * PARTICLE_BITS)] = {}, bytes[words_of(64 * NODES)] = {};
};

}  // namespace

extern "C" {

int cuboct_abi() { return kCuboctAbi; }
void* cuboct_create(uint32_t seed) { return new Lattice(seed); }
void cuboct_destroy(void* handle) { delete static_cast<Lattice*>(handle); }

void cuboct_clock_lattice(void* handle, const CuboctIn* host, uint32_t load_node, CuboctOut* out) {
  Lattice& l = *static_cast<Lattice*>(handle);
  Vcuboct_lattice& m = *l.model;
  m.rst_ni = host->reset_n;
  m.start_i = host->start;
  m.steps_i = host->steps;
  m.load_valid_i = host->load_valid;
  m.load_node_i = load_node;
  if (host->load_valid) set_port(m.load_data_i, host->load_data);
  m.clk_i = 0;
  m.eval();
  const auto field = [&l](const auto& port, int node, int width) {
    get_port(port, l.bytes);
    uint64_t value[1] = {};
    copy_bits(value, 0, l.bytes, node * width, width);
    return value[0];
  };
  get_port(m.observe_data_o, l.particles);
  for (int n = 0; n < NODES; ++n) {
    CuboctOut& o = out[n];
    o.phase_start = static_cast<uint8_t>(field(m.phase_start_o, n, 8));
    o.phase_end = static_cast<uint8_t>(field(m.phase_end_o, n, 8));
    o.idle = static_cast<uint8_t>(field(m.idle_o, n, 1));
    o.observe_valid = static_cast<uint8_t>(field(m.observe_valid_o, n, 1));
    if (o.observe_valid) copy_bits(o.observe_data, 0, l.particles, n * PARTICLE_BITS, PARTICLE_BITS);
    o.fault_valid = static_cast<uint8_t>(field(m.fault_valid_o, n, 1));
    o.fault_code = static_cast<uint8_t>(field(m.fault_code_o, n, 4));
    o.fault_id = static_cast<uint32_t>(field(m.fault_id_o, n, ID_BITS));
    o.fault_number = static_cast<int64_t>(field(m.fault_number_o, n, 64));
  }
  m.clk_i = 1;
  m.eval();
}

}  // extern "C"
