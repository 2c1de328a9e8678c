// SPDX-License-Identifier: MIT
// cuboct-lattice by itself: its options, its texts, its figures.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>

#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

class LatticeProgram : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return bench_.path(name); }

  Answer run(const std::string& arguments) const {
    const std::string command = "cd '" CUBOCT_SOURCE_DIR "' && '" CUBOCT_LATTICE "' " + arguments + " >'" +
                                path("out") + "' 2>'" + path("err") + "' </dev/null";
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), contents(path("out")), contents(path("err"))};
  }
  Trace traced(const std::string& options) const {
    const Answer answer = run("scenes/lj_block.toml --steps 25 --out '" + path("t.h5") + "' " + options);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return read_trace(path("t.h5"));
  }
  void expect_refusal(const std::string& arguments, const std::string& text) const {
    const Answer answer = run(arguments);
    EXPECT_EQ(answer.code, 2) << arguments;
    EXPECT_EQ(answer.err, text);
  }

  Bench bench_{false};
};

TEST_F(LatticeProgram, NoBitDependsOnItsOptions) {
  const Trace plain = traced("--threads 1");
  ASSERT_EQ(plain.state_hash.size(), 26u);
  EXPECT_EQ(plain.frames.size(), 2u);
  EXPECT_TRUE(plain.cycles.empty());
  for (const char* options :
       {"--threads 3", "--no-quiescence", "--simd portable", "--cycles", "--energies"}) {
    const Trace other = traced(options);
    EXPECT_EQ(other.state_hash, plain.state_hash) << options;
    EXPECT_EQ(other.frames, plain.frames) << options;
  }
  EXPECT_EQ(traced("--cycles").cycles.size(), 25 * plain.nodes * kPhases);
  EXPECT_EQ(traced("--energies").curves.size(),
            6u);  // four energies, the temperature and, in a periodic box, the pressure
}

// Bricks change the nodes and cycles of the machine, and no bit.
TEST_F(LatticeProgram, CountsTheCyclesOfBricks) {
  std::ofstream(path("arch")) << "name = \"bricks\"\n[node]\nbrick = [2, 2, 1]\n";
  const std::string arch = "--arch '" + path("arch") + "'";
  const Trace plain = traced("--cycles"), bricks = traced("--cycles " + arch);
  EXPECT_EQ(bricks.state_hash, plain.state_hash);
  EXPECT_EQ(bricks.frames, plain.frames);
  EXPECT_LT(bricks.nodes, plain.nodes / 2);
  EXPECT_EQ(bricks.cycles.size(), 25 * bricks.nodes * kPhases);
  EXPECT_GT(bricks.counters.at(0).second, 2 * plain.counters.at(0).second);
}

TEST_F(LatticeProgram, HashesAsOftenAsAsked) {
  const Trace every = traced(""), some = traced("--hash-every 10");
  EXPECT_EQ(some.steps(), 25u);
  ASSERT_EQ(some.state_hash.size(), 4u);  // 0, 10, 20 and the last
  for (size_t k = 0; k < 4; ++k) EXPECT_EQ(some.state_hash[k], every.state_hash[some.hashed_step(k)]);
}

TEST_F(LatticeProgram, TakesKeptStepsFromAFile) {
  // More steps than a command line could hold; those of the run are kept.
  std::ofstream list(path("steps"));
  for (int k = 30000; k > 0; --k) list << 3 * k << "\n\n";
  list.close();
  const Trace trace = traced("--frames-file '" + path("steps") + "'");
  std::vector<uint64_t> steps;
  for (const State& frame : trace.frames) steps.push_back(frame.step);
  EXPECT_EQ(steps, (std::vector<uint64_t>{3, 6, 9, 12, 15, 18, 21, 24, 25}));
  std::ofstream(path("steps")) << "3\nsix\n";
  expect_refusal("scenes/lj_block.toml --out '" + path("t.h5") + "' --frames-file '" + path("steps") + "'",
                 path("steps") + ":2:1: expected a step, got 'six'\n  hint: one number per line\n");
  expect_refusal("scenes/lj_block.toml --out '" + path("t.h5") + "' --frames-file none",
                 "none: cannot read this file\n");
}

// Until the command that started the program has written all of the run, it could still have to go on.
TEST_F(LatticeProgram, LeavesItsCheckpointToWhoAsks) {
  const std::string options = "--checkpoint-every '10 steps' --checkpoint '" + path("checkpoint") + "'";
  traced(options);
  EXPECT_FALSE(std::filesystem::exists(path("checkpoint")));
  const Trace whole = traced(options + " --keep-checkpoint");
  ASSERT_TRUE(std::filesystem::exists(path("checkpoint")));
  EXPECT_EQ(traced(options + " --resume").state_hash, whole.state_hash);
}

TEST_F(LatticeProgram, TellsItsSpeed) {
  const Answer answer = run("scenes/lj_block.toml --steps 200 --bench --threads 1 --cycles");
  EXPECT_EQ(answer.code, 0) << answer.err;
  const auto value = [&](const std::string& name) {
    std::smatch found;
    const std::regex line("(^|\n)lattice\\." + name + " (\\S+) (1/s|1|s)\n");
    return std::regex_search(answer.out, found, line) ? std::stod(found[2]) : -1.0;
  };
  EXPECT_EQ(value("node_steps"), 200 * 27);
  EXPECT_EQ(value("threads"), 1);
  EXPECT_NEAR(value("particle_steps") * value("seconds"), 200 * 256, 1);
  EXPECT_NEAR(value("node_cycles") * value("seconds"), value("cycles") * 27, 1e-4 * value("cycles") * 27);
  EXPECT_FALSE(std::filesystem::exists(path("t.h5")));
}

TEST_F(LatticeProgram, RefusesWhatItCannotDo) {
  expect_refusal("scenes/lj_block.toml", "--out is required\n");
  expect_refusal("scenes/lj_block.toml --log rows",
                 "--log: rows not in {off,quiet,seconds,parts}\nRun with --help for more information.\n");
  expect_refusal("scenes/lj_block.toml --out none/t.h5",
                 "cannot write none/t.h5: No such file or directory\n");
  expect_refusal("scenes/none.toml --out '" + path("t.h5") + "'",
                 "scenes/none.toml: cannot read this file\n");
  EXPECT_EQ(run("scenes/lj_block.toml --simd mmx --out '" + path("t.h5") + "'").code, 2);
  EXPECT_NE(run("scenes/lj_block.toml --simd mmx --out '" + path("t.h5") + "'").err.find("mmx"),
            std::string::npos);
}

}  // namespace
}  // namespace cuboct::test
