// SPDX-License-Identifier: MIT
// rtl_small_case NAME DIR: emits the project of a small case. Exit status 0, or 2.
#include <cstdio>
#include <exception>

#include "hw/rtl/rtl_emit.h"
#include "model/base/error.h"
#include "tests/verify/small_case.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: rtl_small_case NAME DIR\nNAME:");
    for (const auto& name : cuboct::test::small_names()) std::fprintf(stderr, " %s", name.c_str());
    std::fprintf(stderr, "\n");
    return 2;
  }
  try {
    const auto c = cuboct::test::small_case(argv[1]);
    try {
      cuboct::emit_rtl(c.setup.plan, c.setup.initial, argv[2], {.vector_steps = c.steps});
    } catch (const cuboct::RunError& e) {  // the bench ends before the step that faults
      cuboct::emit_rtl(c.setup.plan, c.setup.initial, argv[2], {.vector_steps = e.step});
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rtl_small_case: %s\n", e.what());
    return 2;
  }
  return 0;
}
