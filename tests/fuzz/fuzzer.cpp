// SPDX-License-Identifier: MIT
// What libFuzzer calls: the target that the environment's CUBOCT_FUZZ names.
#include <fmt/format.h>

#include <cstdlib>

#include "tests/fuzz/targets.h"

// A small machine with one core: what a few bytes may ask for is far below it.
#define free_memory free_memory_of_machine
#define usable_cores usable_cores_of_machine
#include "model/base/resources.cpp"  // NOLINT: in the place of the library's
#undef free_memory
#undef usable_cores

namespace cuboct {

uint64_t free_memory() { return uint64_t{256} << 20; }
int usable_cores() { return 1; }

namespace {

const fuzz::Target& chosen() {
  const char* const name = std::getenv("CUBOCT_FUZZ");
  for (const fuzz::Target& target : fuzz::CUBOCT_FUZZ_TARGETS())
    if (name != nullptr && target.name == name) return target;
  fmt::print(stderr, "CUBOCT_FUZZ names none of the targets:");
  for (const fuzz::Target& target : fuzz::CUBOCT_FUZZ_TARGETS()) fmt::print(stderr, " {}", target.name);
  fmt::print(stderr, "\n");
  std::exit(2);
}

}  // namespace
}  // namespace cuboct

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const cuboct::fuzz::Target& target = cuboct::chosen();
  target.take({data, size});
  return 0;
}
