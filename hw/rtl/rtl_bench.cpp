// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "hw/rtl/rtl_ports.h"
#include "hw/rtl/rtl_template.h"
#include "model/contract/golden.h"
#include "model/program/integer_program.h"
#include "model/trace/trace.h"

namespace cuboct {
namespace {

// Bits appended least significant first.
class BitWord {
 public:
  void add(int64_t value, int bits) {
    for (int b = 0; b < bits; ++b) bits_.push_back(static_cast<uint64_t>(value) >> b & 1);
  }
  std::string hex() const {
    std::string text;
    for (size_t low = 0; low < bits_.size(); low += 4) {
      int digit = 0;
      for (size_t b = 0; b < 4 && low + b < bits_.size(); ++b) digit |= bits_[low + b] << b;
      text += "0123456789abcdef"[digit];
    }
    std::reverse(text.begin(), text.end());
    return text;
  }

 private:
  std::vector<int> bits_;
};

// Placeholders in capitals between @ are replaced; the rest is the file.
constexpr const char* kBench =
    R"sv(// Loads the lattice, runs Steps steps and compares every particle that a node shows with golden's. Then it reads the
// last state back as hosts do, a node at a time. +waves writes cuboct_bench.vcd, where the simulator can.
`timescale 1ns / 1ns
module cuboct_bench;
  localparam int Nodes        = @NODES@;
  localparam int ProbeNodes   = Nodes;
  localparam int ParticleBits = cuboct_pkg::ParticleBits;
  localparam int IdBits       = cuboct_pkg::IdBits;
  localparam int Loads        = @LOADS@;
  localparam int Expected     = @EXPECTED@;
  localparam int Steps        = @STEPS@;
  localparam int Limit        = @LIMIT@;  // cycles; a run that takes longer hangs

@CELLS@@SIGNALS@@VELOCITY@
  cuboct_lattice #(.Probe(1)) u_lattice (
@PORTS@
  );

  // Words are {@CELL_WORD@node, particle}; {step, @CELL_WORD@slot, particle}, all of node 0 in the order of time, then of node 1, ...;
  // and where each node's begin, with the end.
  logic [ParticleBits+@LOAD_TOP@:0] loads [0:Loads-1];
  logic [ParticleBits+63:0] expected [0:Expected-1];
  logic [31:0] first [0:Nodes];

  integer next [0:Nodes-1];
  integer last [0:Nodes-1];  // where the last state of a node begins; -1: it has no particle
  integer n, k, cycle, compared, phases, counted;
  logic [ParticleBits-1:0] got, want;
  logic [31:0] step@SLOT@;
  logic running, reads;

  initial clk = 1'b0;
  always #5 clk = !clk;

  initial begin
    $readmemh("loads.hex", loads);
    $readmemh("expected.hex", expected);
    $readmemh("first.hex", first);
    for (n = 0; n < Nodes; n = n + 1) next[n] = first[n];
    rst_n = 1'b0; start = 1'b0; load_valid = 1'b0; node = '0; load_data = '0; running = 1'b0;
    select = 1'b0; steps = '0;
  end

  initial if ($test$plusargs("waves")) begin
    $dumpfile("cuboct_bench.vcd");
    $dumpvars(0, cuboct_bench);
  end

  // Four cycles of reset, a particle per cycle, start.
  integer tick;
  initial tick = 0;
  always @(posedge clk) begin
    tick       <= tick + 1;
    rst_n      <= (tick >= 4);
    load_valid <= (tick >= 6 && tick < 6 + Loads);
    if (tick >= 6 && tick < 6 + Loads) {@LOAD_CELL@node, load_data} <= loads[tick-6];
    start      <= (tick == 6 + Loads);
    steps      <= Steps;
    select     <= 1'b0;
    if (tick == 7 + Loads) running <= 1'b1;
    if (reads) begin
      start  <= idle && !start && reader < Nodes;
      select <= idle && !start && reader < Nodes;
      node   <= reader;
      steps  <= 32'd0;
    end
  end

  initial begin
    cycle    = 0;
    compared = 0;
    phases   = 0;
    counted  = 0;
  end
  always @(posedge clk) if (running && !reads) begin
    if (!(&probe_idle)) cycle = cycle + 1;
    if (busy) counted = counted + 1;
    for (k = 0; k < Nodes; k = k + 1) begin
      if (probe_fault_valid[k]) begin
        $display("FAIL node %0d: fault %0d, particle %0d, number %0d", k, probe_fault_code[4*k +: 4],
                 probe_fault_id[IdBits*k +: IdBits], $signed(probe_fault_number[64*k +: 64]));
        $fatal(1, "fault");
      end
      if (probe_observe_valid[k]) begin
        got = probe_observe_data[ParticleBits*k +: ParticleBits];
        if (next[k] >= first[k+1]) begin
          $display("FAIL node %0d: observes a particle more than golden has", k);
          $fatal(1, "more");
        end
        {step, @OWN_CELL@slot, want} = expected[next[k]];
@CELL_CHECK@@FIELDS@        compared = compared + 1;
        if (step == Steps && last[k] < 0) last[k] = next[k];
        next[k] = next[k] + 1;
      end
      if (probe_phase_end[@PHASES@*k+@LAST@]) phases = phases + 1;
    end
    if (cycle > 0 && idle) begin
      for (k = 0; k < Nodes; k = k + 1) if (next[k] != first[k+1]) begin
        {step, @OWN_CELL@slot, want} = expected[next[k]];
        $display("FAIL step %0d node %0d slot %0d: particle %0d was not observed", step, k, slot,
                 want[@IDLSB@ +: IdBits]);
        $fatal(1, "less");
      end
      if (compared != Expected || phases != Steps * Nodes) begin
        $display("FAIL %0d of %0d comparisons, %0d of %0d steps of nodes", compared, Expected, phases,
                 Steps * Nodes);
        $fatal(1, "count");
      end
      if (counted != cycle) begin
        $display("FAIL busy_o was high in %0d cycles of %0d", counted, cycle);
        $fatal(1, "busy");
      end
      reads <= 1'b1;
    end
    if (cycle > Limit) begin
      for (k = Nodes - 1; k > 0 && probe_idle[k]; k = k - 1) ;
      $display("FAIL node %0d: still busy after %0d cycles", k, cycle);
      $fatal(1, "timeout");
    end
  end

  // Node by node: start with select shows its particles.
  integer reader, read, place, m;
  initial begin
    reads  = 1'b0;
    reader = 0;
    read   = 0;
    place  = 0;
    for (m = 0; m < Nodes; m = m + 1) last[m] = -1;
  end
  always @(posedge clk) if (reads) begin
    if (observe_valid) begin
      want = expected[last[reader-1]+place][0 +: ParticleBits];
      if (place >= first[reader] - last[reader-1] || observe_data !== want) begin
        $display("FAIL node %0d: reads particle %0d of the last state as %h, golden has %h", reader - 1, place,
                 observe_data, want);
        $fatal(1, "read");
      end
      place = place + 1;
      read  = read + 1;
    end
    if (start) reader <= reader + 1;
    if (start) place = 0;
    if (idle && !start && reader == Nodes) begin
      if (read != Loads || faulty) begin
        $display("FAIL %0d of %0d particles were read, fault %0d", read, Loads, faulty);
        $fatal(1, "read");
      end
      $display("PASS %0d comparisons, %0d steps, %0d nodes, %0d cycles", compared, Steps, Nodes, cycle);
      $finish;
    end
  end

  logic unused_phases;
  assign unused_phases = ^{probe_phase_start, settled, fault_valid, fault_code, @STAGE@fault_id, fault_number@UNUSED@};
endmodule
)sv";

constexpr const char* kMakefile = R"(# @MAKER@
# Targets: lint, verilator, icarus, yosys; waves: cuboct_bench.vcd, of icarus. Each runs in this directory.
RTL := $(addprefix ../,$(shell cat ../files.f))
VERILATOR ?= verilator
IVERILOG ?= iverilog
YOSYS ?= yosys

all: lint verilator icarus yosys

# The node once with all that it holds, then the lattice with the node's ports alone: Verilator looks into every instance,
# which for a thousand nodes takes minutes and tells nothing new. Constants that it then finds unused are the node's.
lint:
	$(VERILATOR) --lint-only -Wall --top-module cuboct_node $(RTL)
	$(VERILATOR) --lint-only -Wall -Wno-UNUSEDPARAM --top-module cuboct_lattice $(filter-out ../rtl/cuboct_node%,$(RTL)) lint/cuboct_node.sv

# The constant bit-operation tree of Verilator 5.006 is wrong in rare cases; without it nothing is slower. Its makefile
# refuses a CURDIR with a blank, and looks at that alone.
verilator: obj_dir/cuboct_bench
	./obj_dir/cuboct_bench
obj_dir/cuboct_bench: $(RTL) cuboct_bench.sv
	$(VERILATOR) --binary --timing -fno-const-bit-op-tree -Wno-fatal -O3 -MAKEFLAGS OPT_FAST=-O1 -MAKEFLAGS CURDIR=obj_dir --Mdir obj_dir -o cuboct_bench \
	  --top-module cuboct_bench $(RTL) cuboct_bench.sv

# With always_comb Icarus 11 hangs in this design: time stands still at 445. The cause is not known. With always @* the
# same blocks simulate, to the same values.
icarus: icarus/cuboct_bench.vvp
	vvp -n icarus/cuboct_bench.vvp
icarus/cuboct_bench.vvp: $(RTL) cuboct_bench.sv
	mkdir -p icarus
	for f in $(notdir $(RTL)); do sed 's/always_comb/always @*/;s/always_ff/always/' ../rtl/$$f > icarus/$$f; done
	$(IVERILOG) -g2012 -DSYNTHESIS -o $@ -s cuboct_bench $(addprefix icarus/,$(notdir $(RTL))) cuboct_bench.sv \
	  2> icarus/log || { cat icarus/log; exit 1; }

waves: icarus/cuboct_bench.vvp
	vvp -n icarus/cuboct_bench.vvp +waves

yosys:
	$(YOSYS) -q -p 'read_verilog -sv $(RTL); hierarchy -check -top cuboct_lattice; proc; check -assert'

clean:
	rm -rf obj_dir icarus cuboct_bench.vcd
.PHONY: all lint verilator icarus waves yosys clean
)";

constexpr const char* kReadme = R"(@MAKER@

A lattice of @NODES@ particle processors in SystemVerilog, self-contained.

| file | what |
|---|---|
| `rtl/cuboct_pkg.sv` | the plan's constants |
@LAW_ROWS@| `rtl/cuboct_node.sv` | one node |
| `rtl/cuboct_lattice.sv` | the nodes and their links: the top module |
| other files of `rtl/` | the library that they use |
| `files.f` | all of them, in the order to read |
| `project.json` | the plan for other programs: hash, nodes, widths, cycles per step, files; `cuboct synth` reads it |
| `docs/reference/` | the pages that the modules' comments name: `node.md` has the node cycle by cycle |
| `bench/` | a bench that loads @LOADS@ particles, runs @STEPS@ steps and compares each observed particle with golden's |

    cd bench && make verilator     # or: icarus, lint, yosys; waves: cuboct_bench.vcd

Verilator compiles before it runs: some 15 s with 2 nodes, 80 s with 20. Icarus compiles those in 0.3 and 2 s, simulates 20 nodes at
0.7 steps/s, and needs minutes to compile 100 nodes: there take `make verilator`. With the pair law a `brick` in the arch makes fewer nodes.

The bench ends with `PASS n comparisons, ...` and exit status 0, or with `FAIL`, the place and another status.

## Ports of cuboct_lattice

| port | | bits | meaning |
|---|---|---|---|
@PORT_ROWS@
Nodes have the numbers 0 to @LAST_NODE@. Commands come to all nodes after @TO@ cycles; what nodes show comes after @BACK@.

- **Clock and reset.** One clock, rising edge; no clock enable. `rst_ni` is synchronous: low for one edge or more, at any time.
  It empties all nodes, and node 0 is the one observed. Memories need no reset.
- **Load.** While `idle_o` is high, one particle in each cycle with `load_valid_i`: it goes to node `node_i`, into its next slot.
- **Start.** `start_i` for one cycle with `idle_o`, without `load_valid_i`; the cycle after the last load will do. `idle_o` falls in
  the next cycle and is high again when all steps are done and all that was observed has come. `busy_o` is high in as many
  cycles as the run took.
- **Observe.** `select_i` for one cycle makes `node_i` the node observed, from the cycle with `settled_o` on. Its particles come
  with `observe_valid_o`, in the order of its slots, at the start of each step and after the last. A start with `steps_i` = 0
  and `select_i` in the same cycle shows them and changes nothing: so a host reads a state, node by node.
- **Faults.** `faulty_o`: some node had a fault, the state is of no use. `fault_valid_o` and its company tell the first fault of the
  node observed.

An instantiation:

```systemverilog
module my_design (
@OWN_PORTS@);
  /* verilator lint_off PINMISSING */  // probe_*
  cuboct_lattice u_lattice (
@OWN_PINS@
  );
  /* verilator lint_on PINMISSING */
endmodule
```

## The particle of load_data_i and observe_data_o

| field | lowest bit | bits | |
|---|---|---|---|
@FIELD_ROWS@
## The plan

@PLAN@)";

std::string port_rows(const RtlDesign& design) {
  std::string rows;
  for (const RtlPort& p : lattice_ports(design))
    rows += fmt::format("| `{}` | {} | `{}` | {} |\n", p.name, p.output ? "out" : "in", p.bits, p.meaning);
  return rows;
}

// What a number of a rule's field is: its name there, and what one is worth.
std::string field_meaning(const IntegerProgram& program, int number) {
  const std::vector<graph::Field>& fields = program.program.fields;
  size_t k = 0;
  while (number >= fields[k].numbers) number -= fields[k++].numbers;
  const std::string part = fields[k].numbers > 1 ? fmt::format(".{}", "xyz"[number]) : "";
  const FieldScale& scale = program.scales[k];
  return fmt::format("`{}{}` of the rule, times {:.6g} in SI units", fields[k].name, part,
                     std::ldexp(scale.unit, -scale.frac));
}

std::string field_rows(const Plan& plan) {
  std::string rows;
  for (const WordField& f : plan.words.particle) {
    std::string meaning = f.is_signed ? "signed" : "";
    if (f.kind == FieldKind::field)
      meaning += (f.is_signed ? "; " : "") + field_meaning(*plan.program, f.number);
    rows += fmt::format("| `{}` | {} | {} | {} |\n", name_of(f), f.lsb, f.bits, meaning);
  }
  return rows;
}

// The files of rtl/ that hold what the plan's law or rule computes.
const char* law_rows(const RtlDesign& design) {
  return design.text ? "| `rtl/cuboct_pair_K.sv`, `rtl/cuboct_finish_K.sv` | what round K computes of a "
                       "pair, and of a "
                       "particle |\n"
                       "| `rtl/cuboct_rule_*.sv` | the rounds together, and what others see of a particle |\n"
                     : "| `rtl/cuboct_*_rom.sv` | its tables |\n";
}

// A state as the bench holds it: golden's particles by cell, and of a rule the numbers of its fields by id
// and of its bonds.
class Shown {
 public:
  Shown(const Plan& plan, const Golden& golden) : golden_(golden) {
    if (plan.program == nullptr) return;
    numbers_ = static_cast<size_t>(plan.program->program.numbers());
    bond_numbers_ = static_cast<size_t>(plan.program->program.bond_numbers());
    rows_ = plan.program->rows.get();
    State state = golden.state();
    fields_ = std::move(state.fields), bonds_ = std::move(state.bonds);
  }
  const std::vector<Particle>& of(uint32_t cell) const { return golden_.cells()[cell]; }
  int64_t field(uint32_t id, int number) const {
    return fields_[id * numbers_ + static_cast<size_t>(number)];
  }
  // Of a place in the particle's row; one without bond has its own id.
  int64_t bond(uint32_t id, const WordField& f) const {
    const uint64_t b = rows_->first[id] + static_cast<uint64_t>(f.place);
    const bool there = b < rows_->first[id + 1];
    if (f.kind == FieldKind::bond_other) return there ? rows_->other[b] : id;
    if (f.kind == FieldKind::bond_kind) return there ? rows_->kind[b] : 0;
    return there ? bonds_[b * bond_numbers_ + static_cast<size_t>(f.number)] : 0;
  }

 private:
  const Golden& golden_;
  size_t numbers_ = 0, bond_numbers_ = 0;
  const graph::BondRows* rows_ = nullptr;
  std::vector<int64_t> fields_, bonds_;
};

// {above, particle}; above are 32-bit words, least significant first.
std::string particle_hex(const Plan& plan, const Shown& state, const Particle& particle,
                         std::initializer_list<uint64_t> above) {
  BitWord word;
  for (const WordField& f : plan.words.particle) {
    const auto value = [&]() -> int64_t {
      switch (f.kind) {
        case FieldKind::position:
          return particle.x[f.axis] >> plan.rule.widths.guard;
        case FieldKind::residue:
          return particle.x[f.axis];
        case FieldKind::velocity:
          return particle.v[f.axis];
        case FieldKind::type:
          return particle.type;
        case FieldKind::id:
          return particle.id;
        case FieldKind::displacement:
          return particle.u[f.axis];
        case FieldKind::field:
          return state.field(particle.id, f.number);
        case FieldKind::bond_other:
        case FieldKind::bond_kind:
        case FieldKind::bond_field:
          return state.bond(particle.id, f);
        case FieldKind::away:
        case FieldKind::cell:
          break;
      }
      return 0;
    };
    word.add(value(), f.bits);
  }
  for (const uint64_t more : above) word.add(static_cast<int64_t>(more), 32);
  return word.hex() + "\n";
}

// Of a brick, of which the bench sees the cell too; the place of a particle's id.
constexpr const char* kCellCheck =
    R"(        if (probe_observe_cell[CellBits*k +: CellBits] !== own_cell[CellBits-1:0]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: cell is %0d, golden has %0d", step, k, slot,
                   want[{} +: IdBits], probe_observe_cell[CellBits*k +: CellBits], own_cell);
          $fatal(1, "differs");
        end
)";

std::string print_fields(const Plan& plan, int& id_lsb) {
  std::string text;
  for (const WordField& f : plan.words.particle)
    if (f.kind == FieldKind::id) id_lsb = f.lsb;
  for (const WordField& f : plan.words.particle) {
    const auto part = [&](const char* word) {
      return f.is_signed ? fmt::format("$signed({}[{} +: {}])", word, f.lsb, f.bits)
                         : fmt::format("{}[{} +: {}]", word, f.lsb, f.bits);
    };
    text += fmt::format(
        "        if (got[{0} +: {1}] !== want[{0} +: {1}]) begin\n"
        "          $display(\"FAIL step %0d node %0d slot %0d particle %0d: {2} is %0d, golden has %0d\", "
        "step, k,\n"
        "                   slot, want[{3} +: IdBits], {4}, {5});\n"
        "          $fatal(1, \"differs\");\n"
        "        end\n",
        f.lsb, f.bits, name_of(f), id_lsb, part("got"), part("want"));
  }
  return text;
}

}  // namespace

std::map<std::string, std::string> print_bench(const Plan& plan, const RtlDesign& design,
                                               const State& initial, uint64_t steps) {
  const uint32_t nodes = plan.nodes();
  Golden golden = plan.program == nullptr ? Golden(plan.rule, plan.lattice, plan.arch.capacity, initial)
                                          : Golden(plan.program->program, plan.lattice, plan.arch.capacity,
                                                   initial, plan.program->rows);
  std::string loads;
  const bool bricks = design.bricks();
  const auto of_node = [&](uint32_t n) {
    std::vector<std::pair<uint32_t, uint32_t>> cells;  // of the lattice, and which one of the node's
    if (!bricks) return cells.emplace_back(n, 0), cells;
    for (uint32_t local = 0; local < cells_of(plan.bricks.shape()); ++local)
      if (const uint32_t cell = plan.bricks.cell(n, local); cell != kNoCell) cells.emplace_back(cell, local);
    return cells;
  };
  const Shown begin(plan, golden);
  for (uint32_t n = 0; n < nodes; ++n)
    for (const auto& [cell, local] : of_node(n))
      for (const Particle& p : begin.of(cell))
        loads += bricks ? particle_hex(plan, begin, p, {n, local}) : particle_hex(plan, begin, p, {n});
  std::vector<std::string> expected(nodes);
  std::vector<uint64_t> count(nodes);
  for (uint64_t step = 0;; ++step) {
    const Shown now(plan, golden);
    for (uint32_t n = 0; n < nodes; ++n)
      for (const auto& [cell, local] : of_node(n))
        for (size_t slot = 0; slot < now.of(cell).size(); ++slot, ++count[n])
          expected[n] += particle_hex(plan, now, now.of(cell)[slot], {uint64_t{local} << 16 | slot, step});
    if (step == steps) break;
    golden.step();
  }
  std::string all, first;
  uint64_t total = 0;
  for (uint32_t n = 0; n < nodes; ++n) {
    first += fmt::format("{:08x}\n", total);
    total += count[n];
    all += expected[n];
  }
  first += fmt::format("{:08x}\n", total);
  if (initial.particles.empty()) throw InputError("RTL: the bench needs a particle");

  // No step takes longer: in every round, every record that there can be sent three times, met by every row,
  // every pair issued alone.
  const auto c = static_cast<uint64_t>(plan.arch.capacity);
  const uint64_t records = std::min<uint64_t>(27 * c, initial.particles.size());
  const uint64_t cells = cells_of(plan.bricks.shape());
  uint64_t longest = 0;
  for (const PlanRound& round : plan.rounds) {
    const auto beats = static_cast<uint64_t>(std::max(round.beats, plan.words.migrate_beats));
    const auto latencies = static_cast<uint64_t>(std::max(300, 200 + round.pipe + round.finish));
    longest += (steps + 2) * (4 * records * beats + 2 * c * records + latencies) * cells;
  }
  const uint64_t limit = std::min<uint64_t>(longest, INT32_MAX);  // what an int holds

  std::map<std::string, std::string> files;
  int id_lsb = 0;
  const std::string fields = print_fields(plan, id_lsb);
  // A signal for each port, of its name without the end.
  std::string signals;
  std::vector<std::string> connections;
  for (const RtlPort& port : lattice_ports(design)) {
    const std::string signal = port.name.substr(0, port.name.size() - (port.name.ends_with("_ni") ? 1 : 2));
    signals += fmt::format("  logic {}{};\n", range_of(port), signal);
    connections.push_back(fmt::format("    .{}({})", port.name, signal));
  }
  std::vector<RtlPort> own;  // of the host: all but the probes
  std::vector<std::string> pins;
  for (const RtlPort& port : lattice_ports(design))
    if (!port.name.starts_with("probe_")) {
      own.push_back(port);
      pins.push_back("    ." + port.name);
    }
  int levels = 0;  // of cuboct_spread
  for (uint64_t reach = 1; reach < nodes; reach *= 8) ++levels;
  const auto of_bricks = [&](const char* with, const char* without = "") {
    return std::string(bricks ? with : without);
  };
  const std::map<std::string, std::string, std::less<>> values{
      {"MAKER", design.maker},
      {"NODES", std::to_string(nodes)},
      {"LOADS", std::to_string(initial.particles.size())},
      {"EXPECTED", std::to_string(total)},
      {"STEPS", std::to_string(steps)},
      {"LIMIT", std::to_string(limit)},
      {"FIELDS", fields},
      {"IDLSB", std::to_string(id_lsb)},
      {"PLAN", describe(plan)},
      {"PORT_ROWS", port_rows(design)},
      {"FIELD_ROWS", field_rows(plan)},
      {"LAST_NODE", std::to_string(nodes - 1)},
      {"TO", std::to_string(levels)},
      {"BACK", std::to_string(levels > 0 ? levels + 1 : 0)},
      {"OWN_PORTS", print_ports(own)},
      {"OWN_PINS", fmt::format("{}", fmt::join(pins, ",\n"))},
      {"LAST", std::to_string(phase_index(last_phase(plan.rule.axes), 0, design.rounds))},
      {"PHASES", std::to_string(phases_of(design.rounds))},
      {"STAGE", design.text ? "fault_stage, probe_fault_stage, " : ""},
      {"LAW_ROWS", law_rows(design)},
      {"SIGNALS", signals},
      {"PORTS", fmt::format("{}", fmt::join(connections, ",\n"))},
      {"VELOCITY",
       design.moved.empty() ? "" : fmt::format("  assign velocity = {};\n", print_velocities(design))},
      {"CELLS", of_bricks("  localparam int CellBits = cuboct_pkg::CellBits;\n"
                          "  logic [31-CellBits:0] unused_load;\n")},
      {"CELL_WORD", of_bricks("cell, ")},
      {"SLOT", of_bricks(";\n  logic [15:0] slot, own_cell", ", slot")},
      {"OWN_CELL", of_bricks("own_cell, ")},
      {"LOAD_TOP", of_bricks("63", "31")},
      {"UNUSED", of_bricks(", observe_cell, fault_cell, probe_fault_cell")},
      {"LOAD_CELL", of_bricks("unused_load, load_cell, ")},
      {"CELL_CHECK", bricks ? fmt::format(kCellCheck, id_lsb) : std::string()}};
  const auto filled = [&](const char* text) { return fill(text, values); };
  files["bench/cuboct_bench.sv"] =
      "// SPDX-License-Identifier: MIT\n// " + design.maker + "\n" + filled(kBench);
  files["bench/lint/cuboct_node.sv"] = print_node_box(design);
  files["bench/Makefile"] = filled(kMakefile);
  files["bench/loads.hex"] = loads;
  files["bench/expected.hex"] = all;
  files["bench/first.hex"] = first;
  files["README.md"] = filled(kReadme);
  return files;
}

}  // namespace cuboct
