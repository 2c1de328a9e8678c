// SPDX-License-Identifier: MIT
// A command of cuboct-gpu: its line is parsed, it runs, and its errors become exit codes.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace cuboct::gpu {

// What `run` returns; 0 after help, 2 for bad arguments and an InputError, 1 for another exception. Errors
// stand on standard error.
int run_command(CLI::App& app, int argc, char** argv, const std::function<int()>& run);

}  // namespace cuboct::gpu
