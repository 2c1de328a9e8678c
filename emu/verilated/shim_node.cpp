// SPDX-License-Identifier: MIT
// One Verilated node. FACES, LINK_BITS (of link_data), ACK_BITS (0 where links are not checked),
// PARTICLE_BITS, BRICK (1: of a brick) and EVENTS (bits of force_event_o but for the pipes') come from the
// command line. STAGES: 1 of a rule of text.
#include <algorithm>
#include <cstring>
#include <type_traits>
#include <vector>

#include "Vcuboct_node.h"
#include "Vcuboct_node__Syms.h"
#include "Vcuboct_node___024root.h"
#include "shim.h"

namespace {

// An evaluation first settles the logic behind the inputs, then looks for a rising clock, then settles what
// the registers drive. So inputs may come with the edge, and the low half of the clock needs no evaluation of
// its own where Verilator's record of the last clock can be set; where it has another name this returns
// false.
template <typename Root, typename = void>
struct Clock {
  static bool lower(Root&) { return false; }
};
template <typename Root>
struct Clock<Root, std::void_t<decltype(std::declval<Root&>().__Vtrigrprev__TOP__clk_i)>> {
  static bool lower(Root& root) {
    root.__Vtrigrprev__TOP__clk_i = 0;
    return true;
  }
};

// What of a node's inputs may change while its links and its host are silent.
struct QuietInputs {
  bool quiet = false;  // they are silent
  uint8_t link_ready = 0;
  uint32_t steps = 0;
  uint16_t link_ack[FACES] = {};
  QuietInputs() = default;
  explicit QuietInputs(const CuboctIn& in)
      : quiet(in.reset_n && !in.start && !in.load_valid && in.link_valid == 0),
        link_ready(in.link_ready),
        steps(in.steps) {
    std::copy(in.link_ack, in.link_ack + FACES, link_ack);
  }
  bool operator==(const QuietInputs& other) const {
    return quiet == other.quiet && link_ready == other.link_ready && steps == other.steps &&
           std::equal(link_ack, link_ack + FACES, other.link_ack);
  }
};

bool shows(const CuboctOut& out) {
  return (out.phase_start | out.phase_end | out.idle | out.observe_valid | out.fault_valid | out.link_valid |
          out.beat_errors | out.ack_errors) != 0;
}

// A clocked machine whose state, all of it, is the same after a clock stays as it is while its inputs do. The
// whole state with its memories is large; its registers, which come first in Verilator's classes, change in
// most cycles. So the whole is compared only after a cycle in which the first bytes were equal.
class Stillness {
 public:
  void before(const void* state, size_t size, bool same_inputs) {
    size_ = !same_inputs ? 0 : whole_ ? size : std::min(size, kFirst);
    if (size_ == 0) return;
    if (kept.size() < size) kept.resize(size);
    std::memcpy(kept.data(), state, size_);
  }
  // Whether nothing has changed.
  bool after(const void* state, size_t size) {
    whole_ = size_ != 0 && std::memcmp(kept.data(), state, size_) == 0;
    still_ = whole_ && size_ == size;
    return still_;
  }
  // Whether the last cycle changed nothing: then neither does the next one with the same inputs.
  bool still() const { return still_; }

 private:
  static constexpr size_t kFirst = 1024;
  static inline thread_local std::vector<char> kept;
  size_t size_ = 0;  // compared in this cycle
  bool whole_ = false, still_ = false;
};

struct Node : Instance<Vcuboct_node> {
  using Instance::Instance;
  QuietInputs inputs;
  Stillness stillness;
  CuboctOut shown{};         // of the last cycle, if that changed nothing
  uint32_t shown_for = ~0u;  // the inputs that the outputs were last settled for
  uint64_t link_in[words_of(FACES * LINK_BITS)] = {}, link_out[words_of(FACES * LINK_BITS)] = {};
  uint64_t particle[words_of(PARTICLE_BITS)] = {};
  uint64_t ack[words_of(FACES * ACK_BITS)] = {};
};

}  // namespace

extern "C" {

int cuboct_abi() { return kCuboctAbi; }
void* cuboct_create(uint32_t seed) { return new Node(seed); }
void cuboct_destroy(void* handle) { delete static_cast<Node*>(handle); }

#if BRICK
void cuboct_place(void* handle, const uint64_t* extent, const uint64_t* exits) {
  Vcuboct_node& m = *static_cast<Node*>(handle)->model;
  set_port(m.extent_i, extent);
  set_port(m.exit_i, exits);
}
#endif

const char* cuboct_clock(void* handle, const CuboctIn* in, CuboctOut* out) {
  Node& n = *static_cast<Node*>(handle);
  Vcuboct_node& m = *n.model;
  const Vcuboct_node__Syms& state = *m.rootp->vlSymsp;
  const QuietInputs inputs(*in);
  const bool same_inputs = inputs.quiet && inputs == n.inputs;
  if (same_inputs && n.stillness.still()) {  // one that waits and shows that it is idle, say
    *out = n.shown;
    return nullptr;
  }
  n.stillness.before(&state, sizeof state, same_inputs);
  n.inputs = inputs;
  m.rst_ni = in->reset_n;
  m.start_i = in->start;
  m.steps_i = in->steps;
  m.has_link_i = in->has_link;
  m.load_valid_i = in->load_valid;
  if (in->load_valid) set_port(m.load_data_i, in->load_data);
#if BRICK
  const uint64_t load_cell[] = {in->load_cell};
  set_port(m.load_cell_i, load_cell);
#endif
  m.link_ready_i = in->link_ready;
  m.link_valid_i = in->link_valid;
  m.link_end_i = in->link_end;
  if (in->link_valid) {
    for (int f = 0; f < FACES; ++f)
      if (in->link_valid >> f & 1)
        copy_bits(n.link_in, f * LINK_BITS, in->link_data[f], 0, held_bits(LINK_BITS));
    set_port(m.link_data_i, n.link_in);
  }
#if ACK_BITS > 0
  for (int f = 0; f < FACES; ++f) {
    const uint64_t ack = in->link_ack[f];
    copy_bits(n.ack, f * ACK_BITS, &ack, 0, ACK_BITS);
  }
  set_port(m.link_ack_i, n.ack);
#endif
  // What a node shows of a cycle depends on nothing but state and these (docs/reference/node.md); the last
  // edge settled it for the inputs of then.
  const uint32_t shown_for =
      in->link_ready | in->reset_n << 8 | in->start << 9 | in->load_valid << 10 | in->has_link << 16;
  if (shown_for != n.shown_for || !Clock<Vcuboct_node___024root>::lower(*m.rootp)) {
    m.clk_i = 0;
    m.eval();
    n.shown_for = shown_for;
  }
  out->phase_start = m.phase_start_o;
  out->phase_end = m.phase_end_o;
  out->idle = m.idle_o;
  uint64_t events[2] = {};  // at most 2 streamers, 64 pipes
  get_port(m.force_event_o, events);
  out->force_event = static_cast<uint8_t>(events[0] & ((1u << EVENTS) - 1));
  out->pairs =
      static_cast<uint8_t>(__builtin_popcountll(events[0] >> EVENTS) + __builtin_popcountll(events[1]));
  out->observe_valid = m.observe_valid_o;
  if (m.observe_valid_o) {
    get_port(m.observe_data_o, n.particle);
    copy_bits(out->observe_data, 0, n.particle, 0, PARTICLE_BITS);
#if BRICK
    out->observe_cell = m.observe_cell_o;
#endif
  }
  out->fault_valid = m.fault_valid_o;
  if (m.fault_valid_o) {
    out->fault_code = m.fault_code_o;
#if STAGES
    out->fault_stage = m.fault_stage_o;
#endif
    out->fault_id = static_cast<uint32_t>(m.fault_id_o);
    out->fault_number = static_cast<int64_t>(m.fault_number_o);
#if BRICK
    out->fault_cell = m.fault_cell_o;
#endif
  }
#if ACK_BITS > 0
  out->beat_errors = static_cast<uint8_t>(m.link_error_o & ((1u << FACES) - 1));
  out->ack_errors = static_cast<uint8_t>(m.link_error_o >> FACES);
#endif
  m.clk_i = 1;
  m.eval();
  out->link_valid = m.link_valid_o;
  out->link_end = m.link_end_o;
  out->link_ready = m.link_ready_o;
  if (m.link_valid_o) {
    get_port(m.link_data_o, n.link_out);
    for (int f = 0; f < FACES; ++f)
      if (m.link_valid_o >> f & 1)
        copy_bits(out->link_data[f], 0, n.link_out, f * LINK_BITS, held_bits(LINK_BITS));
  }
#if ACK_BITS > 0
  get_port(m.link_ack_o, n.ack);
  for (int f = 0; f < FACES; ++f) {
    uint64_t ack[2] = {};
    copy_bits(ack, 0, n.ack, f * ACK_BITS, ACK_BITS);
    out->link_ack[f] = static_cast<uint16_t>(ack[0]);
  }
#endif
  const bool still = n.stillness.after(&state, sizeof state);
  out->still = still && !shows(*out);
  if (still) n.shown = *out;
  return n.failure();
}

}  // extern "C"
