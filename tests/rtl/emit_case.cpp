// SPDX-License-Identifier: MIT
// emit_case NAME DIR [STEPS]: emits the project of a test case (tests/support/cases.h; random_<seed> is a
// random one, `example` the committed one). emit_case --list prints the names.
#include <cstdio>
#include <string>

#include "hw/rtl_emit.h"
#include "tests/support/block.h"
#include "tests/support/cases.h"

namespace {

// Small enough to read: two nodes, a table of 16 entries.
cuboct::test::Case example() {
  using namespace cuboct;
  Scene scene = test::block_scene({.size = {2, 1, 1}, .jitter = 0.05, .speed = 0.1, .margin = 0});
  Arch arch;
  arch.capacity = 8;
  arch.filter_lanes = 4;
  arch.queue_depth = 4;
  arch.table = {.shape = TableChoice::Shape::uniform, .degree = 1, .index_bits = 4};
  return {"example", make_setup(scene, arch), 2};
}

}  // namespace

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
    const test::Case c = name == "example"             ? example()
                         : name.starts_with("random_") ? test::random_case(std::stoull(name.substr(7)))
                                                       : test::make_case(name);
    emit_rtl(c.setup.plan, c.setup.initial, argv[2], argc == 4 ? std::stoull(argv[3]) : c.steps);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "emit_case: %s\n", e.what());
    return 1;
  }
  return 0;
}
