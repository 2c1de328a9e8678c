// SPDX-License-Identifier: MIT
// Writes the pipelines of a shipped rule, or of a pair law, as SystemVerilog.
// usage: pipeline_case RULE DIR; RULE: a scene of scenes/rules, or pair_law
#include <cstdio>
#include <filesystem>
#include <string>

#include "model/base/output.h"
#include "tests/pipeline/pipelines.h"
#include "tests/pipeline/rules.h"

int main(int argc, char** argv) {
  using namespace cuboct::test;
  if (argc != 3) return std::fputs("usage: pipeline_case RULE DIR\n", stderr), 2;
  const std::string name = argv[1], dir = argv[2];
  std::filesystem::create_directories(dir);
  std::vector<Pipeline> all;
  const auto add = [&](const cuboct::graph::FixedProgram& program) {
    for (const cuboct::graph::Round& round : program.rounds) {
      all.push_back(pair_of(name + "_" + round.name, round));
      all.push_back(finish_of(name + "_" + round.name, program, round));
    }
  };
  add(shipped_rule(name).program.program);
  for (const Pipeline& p : all) {
    for (const auto& module : cuboct::pipeline::print_pipeline(p.name, p.graph, p.outputs, p.schedule))
      cuboct::write_text(dir + "/" + module.name + ".sv", module.text);
    std::printf("%s %d\n", p.name.c_str(), p.schedule.cycles);
  }
}
