// SPDX-License-Identifier: MIT
// `cuboct --version`: what was built, and which programs of engines lie beside it.
#include <fmt/format.h>
#include <unistd.h>

#include <string>

#include "cli/command.h"
#include "cli/commit.h"
#include "emu/lattice/program.h"
#include "model/base/process.h"
#include "model/trace/trace_head.h"

namespace cuboct {
namespace {

bool is_beside(const std::string& program) {
  return access((program_directory() + "/" + program).c_str(), X_OK) == 0;
}

std::string beside(const std::string& program) {
  return is_beside(program) ? program : fmt::format("no program {} beside cuboct", program);
}

std::string lattice() {
  if (!emu::lattice_has_mpi()) return "built in, without MPI";
  return "built in; ranks over MPI: " + beside("cuboct-lattice");
}

#ifdef CUBOCT_HAS_STUDIES
constexpr const char* kStudies = "built in";
#else
constexpr const char* kStudies = "left out";
#endif
#ifdef CUBOCT_HAS_SYNTH
constexpr const char* kSynthesis = "built in";
#else
constexpr const char* kSynthesis = "left out";
#endif

}  // namespace

std::string version_text() {
  std::string out = fmt::format("cuboct {}\ncommit     {}\n", program_version(), commit());
  const auto line = [&](const char* name, const std::string& what) {
    out += fmt::format("{:<10} {}\n", name, what);
  };
  line("golden", "built in");
  line("reference", "built in");
  line("lattice", lattice());
  for (const char* engine : {"systemc", "rtl", "fpga", "gpu"})
    line(engine, beside(fmt::format("cuboct-{}", engine)));
  line("studies", kStudies);
  line("synthesis", kSynthesis);
  out.pop_back();  // CLI11 ends the line
  return out;
}

}  // namespace cuboct
