// SPDX-License-Identifier: MIT
#include "cli/run_fpga.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace cuboct {

void FpgaChoice::add_to(CLI::App& command) {
  command.add_option("--port", port, "serial port of fpga's board, e.g. /dev/ttyUSB0")->type_name("P");
  command.add_option("--baud", baud, "bits per second on it; default: 1000000")
      ->check(CLI::Range(300, 12000000))
      ->type_name("N");
  command
      .add_option("--port-timeout", timeout,
                  "seconds without an answer after which fpga asks the board again; default: 0.3")
      ->check(CLI::Range(0.001, 60.0))
      ->type_name("T");
}

void FpgaChoice::check_unused(const std::string& engine) const {
  const auto refuse = [&](bool given, const char* option) {
    if (given) throw InputError(fmt::format("{} is an option of the fpga engine, not of {}", option, engine));
  };
  refuse(!port.empty(), "--port");
  refuse(baud > 0, "--baud");
  refuse(timeout > 0, "--port-timeout");
}

void FpgaChoice::check_used() const {
  if (port.empty())
    throw InputError("the fpga engine needs --port, where the board is",
                     "--port /dev/ttyUSB0, or what cuboct-board-sim prints");
}

RunningEngine start_fpga(const Input& input, const FpgaChoice& choice, const Request& request,
                         uint64_t hash_every, std::string path, bool progress) {
  choice.check_used();
  std::vector<std::string> more{"--port", choice.port, "--hash-every", std::to_string(hash_every)};
  if (choice.baud > 0) more.insert(more.end(), {"--baud", std::to_string(choice.baud)});
  if (choice.timeout > 0) more.insert(more.end(), {"--timeout", fmt::format("{}", choice.timeout)});
  return {"fpga", input, request, std::move(path), progress, more};
}

}  // namespace cuboct
