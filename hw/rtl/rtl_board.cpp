// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_board.h"

#include <fmt/format.h>

#include "hw/rtl/rtl_library.h"

namespace cuboct {
namespace {

constexpr int kLargest = 65535;  // 16 bits for a node's number, and for a count of particles

std::string print_line(const RtlDesign& design, const BoardChoice& choice) {
  const Board& board = board_of(choice.name);
  return fmt::format(
      "// SPDX-License-Identifier: MIT\n"
      "// {}\n"
      "// The line of the {}: {} baud at {} MHz.\n"
      "package cuboct_board_pkg;\n"
      "  localparam int ClockHz     = {};\n"
      "  localparam int BitClocks16 = {};  // length of a bit in 1/16 clocks\n"
      "endpackage\n",
      design.maker, choice.name, choice.baud, board.clock_hz / 1e6, board.clock_hz,
      bit_clocks16(board, choice.baud));
}

int stage_bits(const Plan& plan) { return plan.program ? kStageBits : 0; }

}  // namespace

std::string print_machine_package(const Plan& plan, const RtlDesign& design) {
  return fmt::format(
      "// SPDX-License-Identifier: MIT\n"
      "// {}\n"
      "// What the host link knows of the plan.\n"
      "package cuboct_machine_pkg;\n"
      "  localparam int          Nodes       = {};\n"
      "  localparam int          CellBits    = {};  // of a cell's number in its node\n"
      "  localparam int          StageBits   = {};  // of a fault's stage, of a rule of text\n"
      "  localparam int          PhaseBits   = {};  // phases of a step\n"
      "  localparam int          Slots       = {};  // of a node\n"
      "  localparam int          VelocityBits = {};\n"
      "  localparam int          MovedTypes  = {};\n"
      "  localparam logic [{}:0] Velocities = {};\n"
      "  localparam logic [63:0] PlanHash    = 64'h{:016x};\n"
      "  localparam logic [63:0] MachineHash = 64'h{:016x};\n"
      "endpackage\n",
      design.maker, plan.nodes(), plan.bricks.cell_bits(), stage_bits(plan), phases_of(design.rounds),
      cells_of(plan.bricks.shape()) * static_cast<uint32_t>(plan.arch.capacity),
      plan.rule.widths.velocity_bits, design.moved.size(), velocities_bits(design) - 1,
      print_velocities(design), plan.hash, machine_hash(plan));
}

void legalise_machine(const Plan& plan) {
  const auto at_most = [](const char* what, uint64_t value, uint64_t limit,
                          const std::vector<std::string>& keys) {
    if (value > limit)
      throw InputError(fmt::format("board: {} is {}: at most {} can be emitted", what, value, limit))
          .about(keys);
  };
  const std::vector<std::string> body{"packing", "particle"};
  at_most("the number of nodes", plan.nodes(), kLargest, {"node.brick", "packing", "particle"});
  const int cell_bits = plan.bricks.cell_bits();
  at_most("the number of slots of a node",
          cells_of(plan.bricks.shape()) * static_cast<uint64_t>(plan.arch.capacity), 32767,
          {"node.capacity", "node.brick"});
  at_most(plan.program ? "the width of a particle's id and of a fault's stage"
                       : "the width of a particle's id and of its cell",
          static_cast<uint64_t>(plan.words.id_bits + cell_bits + stage_bits(plan)), 32, body);
  at_most("the width of a particle and of its cell",
          static_cast<uint64_t>(plan.words.particle_bits) + static_cast<uint64_t>(cell_bits), 512,
          {"widths.velocity_bits", "widths.displacement_bits", "rule.file", "rule"});
  at_most("the number of particles", plan.particles, kLargest, body);
  at_most("the width of a velocity", static_cast<uint64_t>(plan.rule.widths.velocity_bits), 64,
          {"widths.velocity_bits"});
  if (!plan.program)
    at_most("the number of held and moved types", moved_types(plan.rule).size(), 255, {"constraint"});
}

void legalise_board(const Plan& plan, const BoardChoice& choice) {
  bit_clocks16(board_of(choice.name), choice.baud);
  legalise_machine(plan);
}

std::map<std::string, std::string> print_board(const Plan& plan, const RtlDesign& design,
                                               const BoardChoice& choice) {
  std::map<std::string, std::string> files;
  files["board/cuboct_machine_pkg.sv"] = print_machine_package(plan, design);
  files["board/cuboct_board_pkg.sv"] = print_line(design, choice);
  for (const RtlSource& source : rtl_board_library()) {
    const std::string name(source.name);
    const size_t slash = name.find('/');
    if (slash == std::string::npos)
      files["board/" + name] = source.text;
    else if (name.substr(0, slash) == choice.name)
      files["board/" + name.substr(slash + 1)] = source.text;
  }
  return files;
}

std::string list_with(const std::string& lattice_list, const std::string& folder,
                      const std::map<std::string, std::string>& files) {
  std::string packages, modules;
  for (const auto& [path, text] : files)
    if (path.starts_with(folder + "/") && path.ends_with(".sv"))
      (path.ends_with("_pkg.sv") ? packages : modules) += path + "\n";
  return lattice_list + packages + modules;
}

std::string print_board_readme(const Plan& plan, const BoardChoice& choice) {
  const Board& board = board_of(choice.name);
  const bool settable = sets_velocities(plan, choice);
  return fmt::format(
      R"md(
## The board: {0}

`board/` holds what makes a bitstream of the lattice: `cuboct_board_top.sv` (the top module), `cuboct_host_link.sv` (takes a
host's requests from a serial line), `{1}`, and `files.f` (every module, in the order to read; paths are from here).

Build, in this directory (or: `cuboct synth . --target {6} --unit board`):

```
{2}```

Load:

```
{3}```

Run, with the scene that this project was made from; `arch.toml` is the arch that it was made with:

```
cuboct run SCENE --arch arch.toml --engine fpga --port /dev/ttyUSB0 --baud {4}
```

The board answers for plan {5:016x}{7}.

Without a board: this program runs these files under Verilator behind a pseudo-terminal, whose name it prints.

```
cuboct-board-sim . > port &
while ! grep -q . port; do sleep 0.1; done
cuboct run SCENE --arch arch.toml --engine fpga --port "$(cat port)" --baud {4}
kill $!
```
)md",
      board.title, board.pins, board.build, board.flash, choice.baud, plan.hash, board.target,
      settable ? ", or for one that differs in the velocities of held and moved types alone" : " alone");
}

}  // namespace cuboct
