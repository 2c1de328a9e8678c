// SPDX-License-Identifier: MIT
#include <string_view>

#include "emu/gpu/bench/bench.h"
#include "emu/gpu/lps/lps_bench.h"
#include "emu/gpu/many.h"
#include "emu/gpu/program.h"
#include "emu/gpu/samples/multiscale.h"
#include "emu/gpu/samples/samples_bench.h"
#include "model/base/standard_streams.h"

namespace {

int run(int argc, char** argv) {
  if (argc > 1 && argv[1] == std::string_view("bench")) return cuboct::gpu::run_bench(argc - 1, argv + 1);
  if (argc > 1 && argv[1] == std::string_view("samples"))
    return cuboct::gpu::run_samples_bench(argc - 1, argv + 1);
  if (argc > 1 && argv[1] == std::string_view("multiscale"))
    return cuboct::gpu::run_multiscale(argc - 1, argv + 1);
  if (argc > 1 && argv[1] == std::string_view("many")) return cuboct::gpu::run_many(argc - 1, argv + 1);
  if (argc > 1 && argv[1] == std::string_view("lps")) return cuboct::gpu::run_lps_bench(argc - 1, argv + 1);
  return cuboct::gpu::run_gpu_program(argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  return cuboct::with_standard_streams([&] { return run(argc, argv); });
}
