// SPDX-License-Identifier: MIT
#include "emu/lattice/program.h"

#include <malloc.h>

#include "emu/lattice/run.h"
#include "hw/program/options.h"
#include "hw/program/program.h"
#include "model/run/start.h"

namespace cuboct::emu {
namespace {

class LatticeProgram : public EngineProgram {
 public:
  explicit LatticeProgram(Ranks* ranks) {
    name = "cuboct-lattice";
    description = "Runs a scene on vector units and threads, with the bits of the golden engine";
    abilities.cycles = abilities.checkpoints = abilities.text = abilities.any_cells = true;
    choice_.engine.ranks = ranks;
  }

  void add_options(Command& app) override {
    LatticeOptions& engine = choice_.engine;
    app.option("--threads", engine.threads, "Threads; one per core without it").range(1, 4096);
    app.flag("--no-quiescence", no_quiescence_, "Do not skip cells at rest; no bit changes");
    app.option("--simd", engine.simd, "Vector units: avx512, avx2 or portable; the widest without it");
    app.option("--rule-code", rule_code_,
               "How a rule of text runs: interpreted, compiled before the first step, or automatic: compiled "
               "with this program if it ships, else once the run has lasted some seconds")
        .one_of({"automatic", "interpreted", "compiled"})
        .show_default();
    app.option("--cut", engine.cut, "How ranks share the cells: bricks, or slabs along x, y or z")
        .one_of({"bricks", "x", "y", "z"})
        .show_default();
  }

  bool prepare(ProgramOptions&) override {
    choice_.engine.quiescence = !no_quiescence_;
    choice_.engine.rule_code = rule_code_of(rule_code_);
    // Blocks of this size go back to the system when they are freed, as a body of millions does.
    mallopt(M_MMAP_THRESHOLD, 1 << 20);
    return false;
  }

  EngineKind kind(Scene& scene, const Plan& plan, const ProgramOptions& options) override {
    choice_.spare = &scene.body;
    choice_.body_again = [&options] { return load_scene(options.scene, {options.stage, options.from}).body; };
    return lattice_kind(scene, plan, choice_);
  }

  bool leads() const override { return !choice_.engine.ranks || choice_.engine.ranks->rank() == 0; }

  void give_up(int code) override {
    if (choice_.engine.ranks) choice_.engine.ranks->give_up(code);
  }

 private:
  LatticeChoice choice_;
  bool no_quiescence_ = false;
  std::string rule_code_ = "automatic";
};

}  // namespace

bool lattice_has_mpi() {
#ifdef CUBOCT_LATTICE_MPI
  return true;
#else
  return false;
#endif
}

int run_lattice_program(int argc, char** argv, Ranks* ranks) {
  LatticeProgram program(ranks);
  return run_program(argc, argv, program);
}

}  // namespace cuboct::emu
