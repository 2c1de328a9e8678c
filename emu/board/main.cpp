// SPDX-License-Identifier: MIT
// cuboct-fpga: a scene on the board behind a serial port.
#include <fmt/format.h>

#include <limits>
#include <optional>

#include "emu/board/session.h"
#include "hw/program/options.h"
#include "hw/program/program.h"
#include "model/base/standard_streams.h"

namespace cuboct::emu {
namespace {

class BoardProgram : public EngineProgram {
 public:
  BoardProgram() {
    name = "cuboct-fpga";
    description = "Runs a scene on the board behind a serial port";
    abilities.checkpoints = true;
    abilities.text = true;
    abilities.steps = std::numeric_limits<uint32_t>::max();
  }

  void add_options(Command& app) override {
    app.option("--port", port_, "Serial port of the board, e.g. /dev/ttyUSB0").required();
    app.option("--baud", baud_, "Bits per second on it").show_default();
    app.option("--timeout", timeout_, "Seconds of silence after which a request is sent again")
        .range(0.001, 60.0)
        .show_default();
  }

  EngineKind kind(Scene& scene, const Plan& plan, const ProgramOptions&) override {
    host_.emplace(port_, baud_, timeout_);
    return board_kind(*host_, scene, plan);
  }

  void print_end(const Plan& plan, const Trace& trace) override {
    const LinkCount& count = host_->count();
    fmt::print("{} steps of {} particles on {} nodes in {:.0f} cycles; {} requests, {} sent again\n",
               trace.steps(), plan.particles, trace.nodes, trace.counters.front().second, count.requests,
               count.retries);
  }

 private:
  std::string port_;
  int baud_ = 1000000;
  double timeout_ = 0.3;
  std::optional<Host> host_;
};

}  // namespace
}  // namespace cuboct::emu

int main(int argc, char** argv) {
  cuboct::emu::BoardProgram program;
  return cuboct::with_standard_streams([&] { return cuboct::run_program(argc, argv, program); });
}
