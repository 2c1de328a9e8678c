// SPDX-License-Identifier: MIT
// A tool of the build: compiles the rules of scenes, so that runs of such rules need no compiler.
//   cuboct-keep-rules DIRECTORY SCENE[:STAGE]...
#include <fmt/format.h>

#include <cstdio>

#include "emu/lattice/code/library.h"
#include "emu/lattice/rounds/pair_parts.h"
#include "hw/arch/arch.h"
#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/base/standard_streams.h"
#include "model/program/integer_program.h"
#include "model/run/start.h"

namespace cuboct::emu {
namespace {

void keep_rule(const std::string& directory, const std::string& given) {
  const size_t colon = given.find(':');
  const std::string path = given.substr(0, colon);
  Scene scene = load_scene(path, {colon == std::string::npos ? "" : given.substr(colon + 1), {}});
  const Plan plan = program_plan_of(scene, Arch());
  const graph::FixedProgram& program = plan.program->program;
  if (const std::string failed = keep_code(program, is_mutual(program), directory); !failed.empty())
    fmt::print(stderr, "{} is not compiled for each machine: {}\n", given, failed);
}

int keep_rules(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: cuboct-keep-rules DIRECTORY SCENE[:STAGE]...\n");
    return 2;
  }
  try {
    for (int k = 2; k < argc; ++k) keep_rule(argv[1], argv[k]);
    return 0;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}

}  // namespace
}  // namespace cuboct::emu

int main(int argc, char** argv) {
  return cuboct::with_standard_streams([=] { return cuboct::emu::keep_rules(argc, argv); });
}
