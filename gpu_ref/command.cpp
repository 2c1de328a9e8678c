// SPDX-License-Identifier: MIT
#include "gpu_ref/command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "model/base/error.h"

namespace cuboct::gpu {

int run_command(CLI::App& app, int argc, char** argv, const std::function<int()>& run) {
  try {
    app.parse(argc, argv);
    return run();
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const InputError& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "cuboct-gpu: {}\n", e.what());
    return 1;
  }
}

}  // namespace cuboct::gpu
