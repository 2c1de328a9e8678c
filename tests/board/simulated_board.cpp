// SPDX-License-Identifier: MIT
#include "tests/board/simulated_board.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "emu/machine/loop_bench.h"
#include "emu/systemc/node.h"
#include "hw/rtl/rtl_emit.h"
#include "model/contract/golden.h"
#include "model/trace/compare.h"

namespace cuboct::test {
namespace {

std::string contents(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

std::string board_file(const std::string& name) {
  const char* folder = name == "grips.toml"   ? "/scenes/boards/"
                       : name == "board.toml" ? "/scenes/archs/"
                                              : "/tests/board/";
  return CUBOCT_SOURCE_DIR + (folder + name);
}

BoardSetup board_setup(const std::string& scene, const std::string& arch) {
  BoardSetup setup;
  setup.scene = read_scene(board_file(scene));
  static_cast<Setup&>(setup) = make_setup(setup.scene, read_arch(board_file(arch)));
  return setup;
}

Trace run_on_board(emu::Host& host, const BoardSetup& setup, const BoardRun& run) {
  RunRequest request;
  request.steps = run.steps;
  request.frames = run.frames;
  request.hash_every = run.hash_every;
  return record(setup.scene, emu::board_kind(host, setup.scene, setup.plan), request).trace;
}

Answer command(const std::vector<std::string>& arguments) {
  const Scratch scratch;
  const Streams streams{scratch.path("out"), scratch.path("err")};
  const int code = Process(CUBOCT_PROGRAM, arguments, false, streams).wait();
  return {code, contents(streams.out), contents(streams.err)};
}

SimulatedBoard::SimulatedBoard(const Setup& setup, const BoardChoice& board,
                               const std::vector<std::string>& options) {
  const std::string project = scratch_.path("project"), out = scratch_.path("out");
  emit_rtl(setup.plan, setup.initial, project, {.board = board});
  std::vector<std::string> arguments{project, "--build-dir", CUBOCT_TEST_CACHE};
  arguments.insert(arguments.end(), options.begin(), options.end());
  process_ =
      std::make_unique<Process>(CUBOCT_BOARD_SIM, arguments, false, Streams{out, scratch_.path("err")});
  // The board may have to be compiled, on a busy machine for minutes.
  const std::string errors = scratch_.path("err");
  for (int k = 0; k < 25000 && port_.find('\n') == std::string::npos && contents(errors).empty(); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    port_ = contents(out);
  }
  if (port_.empty())
    throw std::runtime_error("cuboct-board-sim did not start: " + contents(scratch_.path("err")));
  port_.pop_back();
}

std::string SimulatedBoard::end() {
  process_.reset();
  return contents(scratch_.path("err"));
}

uint64_t cycles_of(const Setup& setup, uint64_t steps) {
  emu::RunOptions options;
  options.steps = steps;
  options.frames = {steps};
  const Trace trace =
      emu::run_loop_bench(setup.plan, setup.initial, options, emu::native_nodes(setup.plan), "plain").trace;
  std::vector<uint64_t> dumped(trace.nodes);
  for (const Particle& p : trace.frames.back().particles) ++dumped[p.cell];
  const size_t phases = static_cast<size_t>(phases_of(trace.rounds));
  uint64_t last = 0;
  for (uint64_t n = 0; n < trace.nodes; ++n) {
    uint64_t end = 0;
    for (size_t p = 0; p < phases; ++p)
      end = std::max(end, trace.cycles[((steps - 1) * trace.nodes + n) * phases + p].end);
    last = std::max(last, end + 1 + std::max<uint64_t>(1, dumped[n]));
  }
  return last;
}

Trace golden_trace(const Setup& setup, uint64_t steps) {
  Trace trace;
  trace.plan_hash = setup.plan.hash;
  trace.nodes = setup.plan.nodes();
  const Plan& plan = setup.plan;
  Golden golden = plan.program ? Golden(plan.program->program, plan.lattice, plan.arch.capacity,
                                        setup.initial, plan.program->rows)
                               : Golden(plan.rule, plan.lattice, plan.arch.capacity, setup.initial);
  try {
    for (uint64_t step = 0;; ++step) {
      trace.frames.push_back(golden.state());
      trace.state_hash.push_back(hash_of(setup.plan.lattice, trace.frames.back()));
      if (step == steps) break;
      golden.step();
    }
  } catch (const RunError& e) {
    trace.stop = StopReason{e.fault, e.step, e.cell, e.particle, e.number, e.what()};
  }
  return trace;
}

std::string difference(const Plan& plan, const Trace& golden, const Trace& run) {
  if (const auto found = compare(golden, run)) return found->text("golden", "fpga", plan.lattice);
  for (const State& state : run.frames) {
    const State* expected = frame_at(golden, state.step);
    if (expected == nullptr) return fmt::format("a state of step {}", state.step);
    if (const auto found = compare(*expected, state)) return found->text("golden", "fpga", plan.lattice);
  }
  return {};
}

}  // namespace cuboct::test
