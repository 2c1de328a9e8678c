// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_bus.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "hw/rtl/rtl_board.h"
#include "hw/rtl/rtl_library.h"
#include "model/base/spelling.h"

namespace cuboct {

void legalise_bus(const Plan& plan, const BoardChoice& choice) {
  const std::vector<std::string>& all = buses();
  if (std::find(all.begin(), all.end(), choice.bus) == all.end()) {
    const std::string near = did_you_mean(choice.bus, all);
    throw InputError(fmt::format("unknown bus '{}'", choice.bus),
                     near.empty() ? "one of " + list_of(all) : near);
  }
  legalise_machine(plan);
}

std::map<std::string, std::string> print_bus(const Plan& plan, const RtlDesign& design,
                                             const BoardChoice& choice) {
  std::map<std::string, std::string> files;
  files["bus/cuboct_machine_pkg.sv"] = print_machine_package(plan, design);
  const std::set<std::string> machine{"cuboct_machine.sv",  "cuboct_host_link.sv", "cuboct_crc32.sv",
                                      "cuboct_frame_rx.sv", "cuboct_frame_tx.sv",  "cuboct_velocities.sv"};
  for (const RtlSource& source : rtl_board_library())
    if (const std::string name(source.name); machine.contains(name)) files["bus/" + name] = source.text;
  const std::set<std::string> wrapper{"cuboct_mailbox.sv", "cuboct_" + choice.bus + ".sv",
                                      "cuboct_" + choice.bus + "_port.sv"};
  for (const RtlSource& source : rtl_bus_library())
    if (const std::string name(source.name); wrapper.contains(name)) files["bus/" + name] = source.text;
  return files;
}

std::string print_bus_readme(const Plan& plan, const BoardChoice& choice) {
  const bool axi = choice.bus == "axi4lite";
  const bool settable = sets_velocities(plan, choice);
  return fmt::format(
      R"(
## The bus: {0}

`bus/` holds `{1}.sv`, the lattice behind {0}: four registers of 32 bits, an interrupt, one clock and one synchronous
reset, active low. `bus/files.f` lists every module in the order to read; paths are from here.

| address | register | | bits |
|---|---|---|---|
| 0 | DATA | write | 7:0 a byte to the machine; without room the answer is {2} and nothing happens |
| 0 | DATA | read | 7:0 a byte from the machine, which the read takes; 8 there was one |
| 4 | STATUS | read | 0 a byte is there to read; 1 a byte can be written; 2 no run is under way; 3 some node met a fault since the host's RESET; 15:8 bytes to read; 23:16 bytes that can be written |
| 8 | ENABLE | both | 3:0 the interrupt is high while a bit of STATUS and its bit here are |
| 12 | IDENT | read | 43554201: "CUB", version of this table |

The bytes are requests and replies: `cuboct run SCENE --engine fpga --port P` speaks them over any stream of bytes, so a
program that moves bytes between a terminal and DATA is the whole driver. The machine answers for plan {3:016x}{4}.
Without hardware: `cuboct-board-sim .` runs these files under Verilator behind a pseudo-terminal, and prints its name.
)",
      axi ? "AXI4-Lite" : "Wishbone B4, classic cycles", "cuboct_" + choice.bus,
      axi ? "SLVERR" : "`wb_err_o`", plan.hash,
      settable ? ", or for one that differs in the velocities of held and moved types alone" : " alone");
}

}  // namespace cuboct
