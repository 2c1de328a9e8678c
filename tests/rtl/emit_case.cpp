// SPDX-License-Identifier: MIT
// emit_case NAME DIR [STEPS]: emits the project of a test case (tests/support/cases.h; random_<seed> is a random one,
// fault_<name> one that golden refuses: its node alone). emit_case --list prints the names.
#include <cstdio>
#include <string>

#include "hw/rtl_emit.h"
#include "tests/support/cases.h"

int main(int argc, char** argv) {
  using namespace cuboct;
  if (argc == 2 && std::string(argv[1]) == "--list") {
    for (const std::string& name : test::case_names()) std::printf("%s\n", name.c_str());
    return 0;
  }
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: emit_case NAME DIR [STEPS] | --list\n");
    return 2;
  }
  try {
    const std::string name = argv[1];
    const test::Case c =
        name.starts_with("random_") ? test::random_case(std::stoull(name.substr(7))) : test::make_case(name);
    emit_rtl(c.setup.plan, c.setup.initial, argv[2], argc == 4 ? std::stoull(argv[3]) : c.steps);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "emit_case: %s\n", e.what());
    return 1;
  }
  return 0;
}
