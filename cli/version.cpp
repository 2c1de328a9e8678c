// SPDX-License-Identifier: MIT
// `cuboct --version`: what was built, and which programs of engines lie beside it.
#include <fmt/format.h>

#include <string>

#include "cli/command.h"
#include "cli/commit.h"
#include "cli/programs.h"
#include "emu/lattice/program.h"
#include "hw/engine/engines.h"
#include "model/base/process.h"
#include "model/trace/trace_head.h"

namespace cuboct {
namespace {

std::string program_text(const std::string& program) {
  return beside(program).empty() ? fmt::format("no program {} beside cuboct", program) : program;
}

std::string shared(const std::string& program) {
  if (!emu::lattice_has_mpi()) return "built in, without MPI";
  return "built in; ranks over MPI: " + program_text(program);
}

std::string part_text(const BuildPart& part, const std::string& program) {
  if (!part.built) return "left out";
  return beside(program).empty() ? program_text(program) : "built in";
}

}  // namespace

std::string version_text() {
  std::string out = fmt::format("cuboct {}\ncommit     {}\n", program_version(), commit());
  const auto line = [&](const std::string& name, const std::string& what) {
    out += fmt::format("{:<10} {}\n", name, what);
  };
  for (const EngineRow& row : engines())
    line(row.name, !row.program.empty() ? program_text(row.program)
                   : row.ranks.empty()  ? "built in"
                                        : shared(row.ranks));
  line("studies", part_text(kStudies, "cuboct-study"));
  line("fits", part_text(kFits, "cuboct-study"));
  line("synthesis", part_text(kSynthesis, "cuboct-machine"));
  line("view", part_text(kView, "cuboct-view"));
  out.pop_back();  // CLI11 ends the line
  return out;
}

}  // namespace cuboct
